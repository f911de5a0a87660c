"""Bodies in coal and Pinocchio: distances that share no code with the proof."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.certificate.clearance import JointCurve
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel, ConvexPiece

__all__ = ["COAL_ERROR", "Oracle", "coal_shape", "dense_parameters"]

Array = NDArray[np.float64]

COAL_ERROR = 5e-6
"""What coal's distances may be off by [m]."""


def coal_shape(piece: ConvexPiece) -> tuple[coal.CollisionGeometry, pin.SE3]:
    """Return a piece as coal's sphere, capsule or hull, and its placement in its body."""
    points = np.asarray(piece.points, dtype=np.float64)
    if len(points) == 1:
        return coal.Sphere(piece.radius), pin.SE3(np.eye(3), points[0])
    if len(points) == 2:
        line = points[1] - points[0]
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), line).matrix()
        capsule = coal.Capsule(piece.radius, float(np.linalg.norm(line)))
        return capsule, pin.SE3(turn, points.mean(axis=0))
    corners = coal.StdVec_Vec3s()
    for point in points:
        corners.append(point)
    hull = coal.ConvexBase.convexHull(corners, True, "Qt")
    hull.setSweptSphereRadius(piece.radius)
    return hull, pin.SE3.Identity()


class Oracle:
    """Distances of a collision model by Pinocchio's placements and coal."""

    def __init__(self, robot: Robot, model: CollisionModel) -> None:
        """Put every piece into a geometry model, and every pair of pieces.

        Args:
            robot: The robot.
            model: The bodies.
        """
        self.robot = robot
        self.model = model
        self.geometry = pin.GeometryModel()
        pieces: list[list[int]] = []
        for b, body in enumerate(model.bodies):
            base = robot.T_universe_base if body.carrier == 0 else pin.SE3.Identity()
            ids = []
            for n, piece in enumerate(body.pieces):
                shape, placement = coal_shape(piece)
                ids.append(
                    self.geometry.addGeometryObject(
                        pin.GeometryObject(f"{b}/{n}", body.carrier, base * placement, shape)
                    )
                )
            pieces.append(ids)
        groups = []
        for a, b in model.pairs.tolist():
            kinds = (model.bodies[a].kind, model.bodies[b].kind)
            for i in pieces[a]:
                for j in pieces[b]:
                    self.geometry.addCollisionPair(pin.CollisionPair(i, j))
                    groups.append(int("obstacle" in kinds))
        self.group = np.array(groups, dtype=np.int64)
        self.geometry_data = self.geometry.createData()
        self.data = robot.model.createData()

    def distances(self, q: Array) -> Array:
        """Return the distance of every pair of pieces, shape (pairs,) [m]; 0 in contact."""
        configuration = self.robot.configurations(q[None])[0]
        pin.computeDistances(
            self.robot.model, self.data, self.geometry, self.geometry_data, configuration
        )
        found = np.array([r.min_distance for r in self.geometry_data.distanceResults])
        return np.asarray(np.maximum(found, 0.0))

    def least(self, curve: JointCurve, step: float) -> Array:
        """Return the least distance of each group over instants a step apart, shape (2,) [m]."""
        least = np.full(2, np.inf)
        for u in dense_parameters(curve, step):
            found = self.distances(curve.at(float(u)))
            for g in range(2):
                if (self.group == g).any():
                    least[g] = min(least[g], found[self.group == g].min())
        return least


def dense_parameters(curve: JointCurve, step: float) -> Array:
    """Return parameters of a curve between which no joint moves by more than a step."""
    moved = np.abs(np.diff(curve.controls, axis=1)).max(axis=(1, 2)) * 3.0
    counts = np.maximum(np.ceil(moved / step), 1.0).astype(np.int64)
    parts = [k + np.arange(n) / n for k, n in enumerate(counts.tolist())]
    return np.concatenate([*parts, [float(len(counts))]])
