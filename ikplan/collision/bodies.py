"""The bodies of a collision model as flat arrays, in the frames of the compiled chain."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ikplan.arrays import Array, Indices
from ikplan.collision.frames import link_frames
from ikplan.collision.piece_bounds import PieceBounds, bounds_of
from ikplan.kinematics.arm import arm_of
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel

__all__ = ["Bodies", "flat_bodies"]


class Bodies(NamedTuple):
    """Convex pieces and the pairs of them to be kept apart.

    Attributes:
        points: Points of all pieces, each in the frame of its carrier, shape (n, 3) [m].
        first: Indices of each piece's first point, shape (k + 1,); the last entry is n.
        radius: Radius of each piece, shape (k,) [m].
        centre: Centre of a sphere about each piece, in the frame of its carrier, shape (k, 3) [m].
        bound: Radius of that sphere, shape (k,) [m].
        axis: Both ends of the axis of a capsule about each piece, in the frame of its carrier,
            shape (k, 6) [m].
        around: Radius of that capsule, shape (k,) [m].
        spheres: Spheres that cover the pieces, in the frames of their carriers: centre and
            radius, shape (s, 4) [m].
        first_sphere: Indices of each piece's first sphere, shape (k + 1,); the last entry is s.
        box: Axes, one a row, and centre of a box about the points of each piece, in the frame of
            its carrier, shape (k, 12) [m].
        half: Half the edges of that box, shape (k, 3) [m].
        carrier: Link of the chain that carries each piece, 0 for the base, shape (k,).
        moving: Indices of the pieces that a link carries.
        pairs: Two pieces each, that of the lower carrier first, shape (m, 2). Those of whole
            bodies with several pieces are the last; their parts are among those before.
        pair_of: Row of the model's pairs that each belongs to, shape (m,).
        parts: First and last (exclusive) of the pairs that are a pair's parts, shape (m, 2); both
            0 where it has none.
        tops: The pairs that are no parts, in the order of the model's pairs.
        clearance: Least gap asked for [m].
    """

    points: Array
    first: Indices
    radius: Array
    centre: Array
    bound: Array
    axis: Array
    around: Array
    spheres: Array
    first_sphere: Indices
    box: Array
    half: Array
    carrier: Indices
    moving: Indices
    pairs: Indices
    pair_of: Indices
    parts: Indices
    tops: Indices
    clearance: float


def flat_bodies(robot: Robot, model: CollisionModel) -> Bodies:
    """Return the bodies of a model as arrays.

    Args:
        robot: The robot that the model is of.
        model: The bodies and pairs.
    """
    to_chain = _joint_frames(robot)
    first, carrier = [0], list[int]()
    radius, bounds = list[float](), list[PieceBounds]()
    spheres, first_sphere = list[Array](), [0]
    pieces_of: list[list[int]] = []
    for body in model.bodies:
        rows = []
        T = to_chain[body.carrier]
        for about in bounds_of(body, T):
            rows.append(len(radius))
            first.append(first[-1] + len(about.points))
            radius.append(about.radius)
            bounds.append(about)
            spheres.append(about.spheres)
            first_sphere.append(first_sphere[-1] + len(about.spheres))
            carrier.append(body.carrier)
        pieces_of.append(rows)
    points = [about.points for about in bounds]
    sphere = np.array([about.sphere for about in bounds], dtype=np.float64).reshape(-1, 4)
    capsule = np.array([about.capsule for about in bounds], dtype=np.float64).reshape(-1, 7)
    pairs = _pairs_of_pieces(model, pieces_of)
    return Bodies(
        np.ascontiguousarray(np.vstack(points) if points else np.empty((0, 3))),
        np.array(first, dtype=np.int64),
        np.array(radius, dtype=np.float64),
        np.ascontiguousarray(sphere[:, :3]),
        np.ascontiguousarray(sphere[:, 3]),
        np.ascontiguousarray(capsule[:, :6]),
        np.ascontiguousarray(capsule[:, 6]),
        np.ascontiguousarray(np.vstack(spheres) if spheres else np.empty((0, 4))),
        np.array(first_sphere, dtype=np.int64),
        np.array([about.box for about in bounds], dtype=np.float64).reshape(-1, 12),
        np.array([about.half for about in bounds], dtype=np.float64).reshape(-1, 3),
        np.array(carrier, dtype=np.int64),
        np.flatnonzero(np.array(carrier, dtype=np.int64)),
        *pairs,
        model.clearance,
    )


def _pairs_of_pieces(
    model: CollisionModel, pieces_of: list[list[int]]
) -> tuple[Indices, Indices, Indices, Indices]:
    """Return the pairs of pieces, the model's pair of each, their parts and the tops.

    Args:
        model: The bodies and pairs.
        pieces_of: The pieces of each body; after several comes what is about all of them.
    """
    pairs, pair_of, tops = list[tuple[int, int]](), list[int](), list[int]()
    whole, whole_of, parts = list[tuple[int, int]](), list[int](), list[tuple[int, int]]()
    for row, (a, b) in enumerate(np.asarray(model.pairs, dtype=np.int64).reshape(-1, 2)):
        if model.bodies[a].carrier > model.bodies[b].carrier:
            a, b = b, a
        begin = len(pairs)
        for i in pieces_of[a][: len(model.bodies[a].pieces)]:
            for j in pieces_of[b][: len(model.bodies[b].pieces)]:
                pairs.append((i, j))
                pair_of.append(row)
        if len(pairs) == begin + 1:
            tops.append(begin)
        elif len(pairs) > begin:
            tops.append(-1 - len(whole))
            whole.append((pieces_of[a][-1], pieces_of[b][-1]))
            whole_of.append(row)
            parts.append((begin, len(pairs)))
    first = len(pairs)
    return (
        np.array(pairs + whole, dtype=np.int64).reshape(-1, 2),
        np.array(pair_of + whole_of, dtype=np.int64),
        np.array([(0, 0)] * first + parts, dtype=np.int64).reshape(-1, 2),
        np.array([row if row >= 0 else first - 1 - row for row in tops], dtype=np.int64),
    )


@functools.lru_cache(maxsize=128)
def _joint_frames(robot: Robot) -> tuple[pin.SE3, ...]:
    """Per carrier, the pose of the model's joint frame in the link frame of the robot's chain.

    The chain turns each joint's axis to z; the two differ by a constant rotation. Robots do not
    change, so neither do these.
    """
    chain = arm_of(robot).chain
    q = robot.home.copy()  # one compiled kind of arrays
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(q))
    R, p = np.empty((len(chain.prismatic) + 1, 3, 3)), np.empty((len(chain.prismatic) + 1, 3))
    link_frames(chain, q, R, p)
    T_base_universe = robot.T_universe_base.inverse()
    poses = [pin.SE3.Identity()]
    for k in range(1, robot.model.njoints):
        T_chain = pin.SE3(R[k], p[k])
        poses.append(T_chain.inverse() * T_base_universe * data.oMi[k])
    return tuple(poses)
