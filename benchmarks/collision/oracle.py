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
Ints = NDArray[np.int64]

COAL_ERROR = 5e-6
"""What coal's distances may be off by [m]."""
_COARSE = 8
_BODY = 0.5
"""No body reaches farther from its joint [m]."""


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

    def distances(self, q: Array, pairs: Ints | None = None) -> Array:
        """Return the distance of every pair of pieces, or of some, 0 in contact [m]."""
        configuration = self.robot.configurations(q[None])[0]
        pin.updateGeometryPlacements(
            self.robot.model, self.data, self.geometry, self.geometry_data, configuration
        )
        chosen = range(len(self.group)) if pairs is None else pairs.tolist()
        found = [
            pin.computeDistance(self.geometry, self.geometry_data, k).min_distance for k in chosen
        ]
        return np.asarray(np.maximum(found, 0.0))

    def least(self, curve: JointCurve, step: float) -> Array:
        """Return the least distance of each group over instants a step apart, shape (2,) [m].

        Instants farther apart come first; between two of them, the finer ones are left out where
        no body of the robot's size can come as near as the nearest place by then.
        """
        coarse = dense_parameters(curve, _COARSE * step)
        rows = np.array([self.distances(curve.at(float(u))) for u in coarse])
        least = np.full(2, np.inf)
        np.minimum.at(least, self.group, rows.min(axis=0))
        reach = sum(float(np.linalg.norm(m.translation)) for m in self.robot.model.jointPlacements)
        size = 2.0 * (reach + _BODY + float(np.abs(self.robot.upper[self.robot.prismatic]).sum()))
        moved = np.abs(self.robot.coupling) @ np.full(self.robot.dof, _COARSE * step)
        slack = max(size, 1.0) * float(moved.sum())
        for k in range(len(coarse) - 1):
            near = np.flatnonzero(rows[k] - slack < least[self.group])
            if len(near):
                for u in np.linspace(coarse[k], coarse[k + 1], _COARSE + 1)[1:-1]:
                    found = self.distances(curve.at(float(u)), near)
                    np.minimum.at(least, self.group[near], found)
        return least


def dense_parameters(curve: JointCurve, step: float) -> Array:
    """Return parameters of a curve between which no joint moves by more than a step."""
    moved = np.abs(np.diff(curve.controls, axis=1)).max(axis=(1, 2)) * 3.0
    counts = np.maximum(np.ceil(moved / step), 1.0).astype(np.int64)
    parts = [k + np.arange(n) / n for k, n in enumerate(counts.tolist())]
    return np.concatenate([*parts, [float(len(counts))]])
