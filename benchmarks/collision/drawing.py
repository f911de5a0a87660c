"""Random bodies, scenes and motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.collision.oracle import Oracle
from ikplan.certificate.clearance import JointCurve
from ikplan.robots import Robot
from ikplan.scene.body import Body, CollisionModel, ConvexPiece
from ikplan.scene.model import collision_model

__all__ = ["box", "draw_case", "draw_hull", "draw_motion", "link_bodies", "rotation"]

Array = NDArray[np.float64]

_CORNERS = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, -1).T


def rotation(rng: np.random.Generator) -> Array:
    """A rotation drawn evenly, shape (3, 3)."""
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q if np.linalg.det(q) > 0 else -q, dtype=np.float64)


def box(centre: Array, edges: Array, turn: Array | None = None) -> ConvexPiece:
    """A box with its full edges [m]."""
    corners = _CORNERS * (np.asarray(edges) / 2.0)
    return ConvexPiece((corners if turn is None else corners @ turn.T) + np.asarray(centre), 0.0)


def draw_hull(rng: np.random.Generator, size: float, radius: float = 0.0) -> ConvexPiece:
    """Random points on a flattened sphere."""
    points = rng.standard_normal((int(rng.integers(4, 40)), 3))
    points *= size / np.linalg.norm(points, axis=1)[:, None]
    return ConvexPiece(points * rng.uniform(0.3, 1.0, 3), radius)


def link_bodies(robot: Robot, rng: np.random.Generator) -> list[Body]:
    """A body on the base and on every joint: capsules along the arm, hulls, boxes, two pieces."""
    bodies = [Body("base", 0, (ConvexPiece(np.array([[0.0, 0.0, -0.05]]), 0.05),))]
    count = robot.model.njoints - 1
    for k in range(1, count + 1):
        reach = np.zeros(3) if k == count else robot.model.jointPlacements[k + 1].translation
        pieces: tuple[ConvexPiece, ...]
        if np.linalg.norm(reach) < 0.02:
            pieces = (draw_hull(rng, 0.05, float(rng.choice([0.0, 0.01]))),)
        else:
            arm = ConvexPiece(np.stack([np.zeros(3), reach]), 0.03)
            knob = box(reach / 2.0, np.array([0.08, 0.05, 0.06]), rotation(rng))
            pieces = (arm, knob) if rng.random() < 0.5 else (arm,)
        bodies.append(Body(f"link {k}", k, pieces))
    tool = box(np.array([0.0, 0.0, 0.05]), np.array([0.03, 0.06, 0.1]))
    bodies.append(Body("tool", count, (tool,), kind="tool"))
    return bodies


def draw_motion(robot: Robot, rng: np.random.Generator, reach: float, knots: int) -> JointCurve:
    """Cubics between a few random joint values around one, at most ``reach`` away [rad or m].

    Every other motion begins and ends at speed, as a part of a longer one.
    """
    centre = robot.random_configuration(rng)
    span = np.where(robot.prismatic, 0.3, 1.0) * reach
    q = robot.clip(centre) + rng.uniform(-span, span, (knots, robot.dof))
    time = np.linspace(0.0, 5.0, knots)
    dq = np.gradient(q, time, axis=0)
    if rng.random() < 0.5:
        dq[0] = dq[-1] = 0.0
    return JointCurve.of_samples(time, q, dq)


def draw_case(
    robot: Robot,
    rng: np.random.Generator,
    *,
    reach: float,
    knots: int,
    obstacles: int,
    own: bool = False,
) -> tuple[CollisionModel, JointCurve]:
    """A motion among obstacles that do not touch its ends and middle, as they are drawn.

    Pairs of links that touch at the middle of the motion are left out. Links have bodies that are
    drawn, or with ``own`` those of the robot's description.
    """
    links = list(collision_model(robot).bodies) if own else link_bodies(robot, rng)
    curve = draw_motion(robot, rng, reach, knots)
    ends = [curve.at(u) for u in (0.0, 0.5 * (knots - 1), float(knots - 1))]
    bodies = list(links)
    pairs = [
        (i, j)
        for i in range(len(links))
        for j in range(i + 1, len(links))
        if links[j].carrier - links[i].carrier > 1
    ]
    apart = np.zeros(len(pairs), dtype=np.bool_)
    for row, pair in enumerate(pairs):
        one = CollisionModel(tuple(links), np.array([pair], dtype=np.int64), 0.0)
        apart[row] = Oracle(robot, one).distances(ends[1]).min() > 1e-4
    kept = [pair for pair, free in zip(pairs, apart, strict=True) if free]
    length = float(np.abs([m.translation for m in robot.model.jointPlacements]).sum())
    for n in range(obstacles):
        for _ in range(20):
            at = rng.uniform(-1.0, 1.0, 3) * max(length, 0.4)
            kind = int(rng.integers(4))
            piece = (
                box(at, rng.uniform(0.01, 0.4, 3), rotation(rng)),
                ConvexPiece(at[None], float(rng.uniform(0.02, 0.2))),
                ConvexPiece(np.stack([at, at + rng.uniform(-0.3, 0.3, 3)]), 0.03),
                ConvexPiece(draw_hull(rng, 0.2).points + at, float(rng.choice([0.0, 0.02]))),
            )[kind]
            body = Body(f"obstacle {n}", 0, (piece,), kind="obstacle")
            new = [(i, len(bodies)) for i in range(len(links)) if links[i].carrier > 0]
            tried = CollisionModel((*bodies, body), np.array(new, dtype=np.int64), 0.0)
            oracle = Oracle(robot, tried)
            if min(oracle.distances(q).min() for q in ends) > 1e-3:
                bodies.append(body)
                kept += new
                break
    rows = np.array(kept, dtype=np.int64).reshape(-1, 2)
    return CollisionModel(tuple(bodies), rows, 0.0), curve
