"""Random bodies on the joints of an arm, and the same in coal, for comparison."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.robots import Robot
from ikplan.scene.body import Body, CollisionModel, ConvexPiece

Array = NDArray[np.float64]


def blob(rng: np.random.Generator, centre: Array, size: float, radius: float = 0.0) -> ConvexPiece:
    """Random points about a centre; one point is a sphere, two are a capsule."""
    count = int(rng.choice([1, 2, 4, 8, 40]))
    points = centre + size * rng.uniform(-1.0, 1.0, (count, 3))
    return ConvexPiece(points, radius if count > 2 else max(radius, 0.3 * size))


def random_model(
    robot: Robot, rng: np.random.Generator, obstacles: int = 6, clearance: float = 0.0
) -> CollisionModel:
    """A body on every joint, some with two pieces, and obstacles around the base."""
    n = robot.model.njoints
    bodies = [Body("base", 0, (blob(rng, np.zeros(3), 0.05),))]
    for k in range(1, n):
        pieces = tuple(
            blob(rng, rng.uniform(-0.05, 0.05, 3), 0.05) for _ in range(int(rng.integers(1, 3)))
        )
        bodies.append(Body(f"link{k}", k, pieces))
    for k in range(obstacles):
        centre = rng.uniform(-0.7, 0.7, 3) + np.array([0.0, 0.0, 0.5])
        bodies.append(Body(f"box{k}", 0, (blob(rng, centre, 0.08),), kind="obstacle"))
    pairs = [(i, j) for i in range(n) for j in range(i + 2, n)]
    pairs += [(i, n + k) for i in range(1, n) for k in range(obstacles)]
    return CollisionModel(tuple(bodies), np.array(pairs, dtype=np.int64), clearance)


def coal_hull(points: Array) -> coal.CollisionGeometry:
    """The exact hull of some points; a sphere of no radius for a single one."""
    if len(points) == 1:
        return coal.Sphere(0.0)
    if len(points) == 2:
        return coal.Capsule(0.0, float(np.linalg.norm(points[1] - points[0])))
    vectors = coal.StdVec_Vec3s()
    for point in points:
        vectors.append(point)
    return coal.ConvexBase.convexHull(vectors, False, "Qt")


def _placement(points: Array) -> pin.SE3:
    """Where coal's own shape stands in the frame of the piece."""
    if len(points) == 1:
        return pin.SE3(np.eye(3), points[0])
    if len(points) == 2:
        axis = points[1] - points[0]
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis)
        return pin.SE3(turn.matrix(), 0.5 * (points[0] + points[1]))
    return pin.SE3.Identity()


def coal_gaps(robot: Robot, model: CollisionModel, q: Array) -> Array:
    """Gap of each pair by coal and Pinocchio, shape (m,) [m]; 0 or less: in contact."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(q))
    T_base_universe = robot.T_universe_base.inverse()
    frames = [pin.SE3.Identity()]
    frames += [T_base_universe * data.oMi[k] for k in range(1, robot.model.njoints)]
    request = coal.DistanceRequest()
    found = []
    for a, b in model.pairs:
        least = np.inf
        for one in model.bodies[a].pieces:
            for other in model.bodies[b].pieces:
                T_a = frames[model.bodies[a].carrier] * _placement(one.points)
                T_b = frames[model.bodies[b].carrier] * _placement(other.points)
                gap = coal.distance(
                    coal_hull(one.points),
                    coal.Transform3s(T_a.rotation, T_a.translation),
                    coal_hull(other.points),
                    coal.Transform3s(T_b.rotation, T_b.translation),
                    request,
                    coal.DistanceResult(),
                )
                least = min(least, gap - one.radius - other.radius)
        found.append(least)
    return np.array(found)
