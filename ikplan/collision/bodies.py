"""The bodies of a collision model as flat arrays, in the frames of the compiled chain."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ikplan.arrays import Array, Indices
from ikplan.collision.capsules import enclosing_capsule
from ikplan.collision.frames import link_frames
from ikplan.kinematics.chain import Chain
from ikplan.robots import Robot
from ikplan.scene.body import Body, CollisionModel

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
        carrier: Link of the chain that carries each piece, 0 for the base, shape (k,).
        pairs: Two pieces each, that of the lower carrier first, shape (m, 2).
        pair_of: Row of the model's pairs that each belongs to, shape (m,).
        clearance: Least gap asked for [m].
    """

    points: Array
    first: Indices
    radius: Array
    centre: Array
    bound: Array
    axis: Array
    around: Array
    carrier: Indices
    pairs: Indices
    pair_of: Indices
    clearance: float


def flat_bodies(robot: Robot, chain: Chain, model: CollisionModel) -> Bodies:
    """Return the bodies of a model as arrays.

    Args:
        robot: The robot that the model is of.
        chain: Its chain.
        model: The bodies and pairs.
    """
    to_chain = _chain_frames_in_joint_frames(robot, chain)
    points: list[Array] = []
    first, carrier = [0], list[int]()
    radius, spheres, capsules = list[float](), list[Array](), list[Array]()
    pieces_of: list[list[int]] = []
    for body in model.bodies:
        T = to_chain[body.carrier]
        placed = _placed_link if body.kind == "link" else _placed
        rows = []
        for k, moved in enumerate(placed(body, T.rotation.tobytes("F"), T.translation.tobytes())):
            rows.append(len(radius))
            points.append(moved.points)
            first.append(first[-1] + len(moved.points))
            radius.append(body.pieces[k].radius)
            spheres.append(moved.sphere)
            capsules.append(moved.capsule)
            carrier.append(body.carrier)
        pieces_of.append(rows)
    sphere = np.array(spheres, dtype=np.float64).reshape(-1, 4)
    capsule = np.array(capsules, dtype=np.float64).reshape(-1, 7)
    pairs, pair_of = [], []
    for row, (a, b) in enumerate(np.asarray(model.pairs, dtype=np.int64).reshape(-1, 2)):
        if model.bodies[a].carrier > model.bodies[b].carrier:
            a, b = b, a
        for i in pieces_of[a]:
            for j in pieces_of[b]:
                pairs.append((i, j))
                pair_of.append(row)
    return Bodies(
        np.ascontiguousarray(np.vstack(points) if points else np.empty((0, 3))),
        np.array(first, dtype=np.int64),
        np.array(radius, dtype=np.float64),
        np.ascontiguousarray(sphere[:, :3]),
        np.ascontiguousarray(sphere[:, 3]),
        np.ascontiguousarray(capsule[:, :6]),
        np.ascontiguousarray(capsule[:, 6]),
        np.array(carrier, dtype=np.int64),
        np.array(pairs, dtype=np.int64).reshape(-1, 2),
        np.array(pair_of, dtype=np.int64),
        model.clearance,
    )


class _PlacedPiece(NamedTuple):
    """A convex piece in the frame of its carrier.

    Attributes:
        points: Its points, shape (n, 3) [m].
        sphere: Centre and radius of a sphere about it, shape (4,) [m].
        capsule: Both ends and the radius of a capsule about it, shape (7,) [m].
    """

    points: Array
    sphere: Array
    capsule: Array


def _placed(body: Body, rotation: bytes, translation: bytes) -> tuple[_PlacedPiece, ...]:
    """The pieces of a body, moved into the frame of the chain's link."""
    R, p = np.frombuffer(rotation).reshape(3, 3, order="F"), np.frombuffer(translation)
    found = []
    for piece in body.pieces:
        moved = np.asarray(piece.points, dtype=np.float64) @ R.T + p
        middle = 0.5 * (moved.min(axis=0) + moved.max(axis=0))
        bound = float(np.linalg.norm(moved - middle, axis=1).max()) + piece.radius
        begin, end, wide = enclosing_capsule(moved)
        found.append(
            _PlacedPiece(
                moved,
                np.array([*middle, bound]),
                np.concatenate([begin, end, [wide + piece.radius]]),
            )
        )
    return tuple(found)


_placed_link = functools.lru_cache(maxsize=1024)(_placed)
"""The same of the links of robots, which are the same bodies from request to request."""


def _chain_frames_in_joint_frames(robot: Robot, chain: Chain) -> list[pin.SE3]:
    """Per carrier, the pose of the model's joint frame in the chain's link frame.

    The chain turns each joint's axis to z; the two differ by a constant rotation.
    """
    q = robot.home
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(q))
    R, p = np.empty((len(chain.prismatic) + 1, 3, 3)), np.empty((len(chain.prismatic) + 1, 3))
    link_frames(chain, q, R, p)
    T_base_universe = robot.T_universe_base.inverse()
    poses = [pin.SE3.Identity()]
    for k in range(1, robot.model.njoints):
        T_chain = pin.SE3(R[k], p[k])
        poses.append(T_chain.inverse() * T_base_universe * data.oMi[k])
    return poses
