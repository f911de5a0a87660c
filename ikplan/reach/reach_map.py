"""The reach map of an arm: inverse kinematics of many poses, by the batched solver."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array, Flags
from ikplan.documents import parse
from ikplan.documents.scene import Scene, ToolFrame
from ikplan.ik.restarts import restart_into
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.forward import jacobian
from ikplan.pipeline.collisions import requested_model
from ikplan.pipeline.pose_batch.solve import solve_ik_batch
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel
from ikplan.scene.resolve import resolve_scene

__all__ = ["ReachMap", "found_free", "manipulability", "reach_map", "scene_model"]

_BLOCK = 8192
"""Poses that are solved together."""
_BRANCHES = 4
"""Solutions looked at for one that is free of contact."""


@dataclass(frozen=True)
class ReachMap:
    """Which poses an arm reaches; m positions by n orientations.

    Attributes:
        robot: Name of the robot.
        positions: Tool positions in the base, shape (m, 3) [m].
        rotations: Tool orientations in the base, shape (n, 3, 3).
        reached: Poses with a solution that is free of contact, where that is checked, shape (m, n).
        in_contact: Poses all of whose solutions looked at are in contact, shape (m, n).
        q: Joint values, shape (m, n, dof) [rad or m]; NaN where a pose is not reached.
        manipulability: sqrt(det(J J^T)) there, of the tool-frame Jacobian in metres and radians
            (Yoshikawa, Int. J. Robotics Research 1985, 4(2)); below six joints, the product of the
            singular values; shape (m, n), NaN where a pose is not reached.
        clearance: Smallest gap there, shape (m, n) [m]; None: contact is not checked.
    """

    robot: str
    positions: Array
    rotations: Array
    reached: Flags
    in_contact: Flags
    q: Array
    manipulability: Array
    clearance: Array | None

    @property
    def share(self) -> Array:
        """Share of the orientations that are reached at each position, shape (m,)."""
        return np.asarray(self.reached.mean(axis=1))


def reach_map(
    robot: Robot,
    positions: ArrayLike,
    rotations: ArrayLike,
    *,
    scene: Mapping[str, Any] | Scene | None = None,
    restarts: int = 50,
    seed: int = 0,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> ReachMap:
    """Find out which poses an arm reaches.

    A pose that is not found is not proven to be out of reach: the solver gives up after so many
    restarts. Where contact is checked, up to four solutions of a pose are looked at.

    Args:
        robot: The robot, with its tool.
        positions: Tool positions in the base, shape (m, 3) [m].
        rotations: Tool orientations in the base, shape (n, 3, 3).
        scene: What must not be touched, as in a request; ``{}``: the arm itself only; None:
            contact is not checked.
        restarts: Restarts before a pose counts as not reached; of 3,000 random reachable poses of
            iiwa14, panda and ur5 each, none takes more than 50.
        seed: Seed of the restarts.
        threads: Largest number of threads; None: one a processor.
        progress: Is called with the number of poses done and of all.

    Returns:
        The map; it does not depend on the number of threads.

    Raises:
        InvalidRequest: An argument is wrong.
    """
    p = np.array(positions, dtype=np.float64).reshape(-1, 3)
    R = np.array(rotations, dtype=np.float64).reshape(-1, 3, 3)
    count = len(p) * len(R)
    q = np.full((count, robot.dof), np.nan)
    reached, touching = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    quality = np.full(count, np.nan)
    model = scene_model(robot, scene)
    options: dict[str, Any] = {"params": {"restarts": restarts}, "seed": seed, "threads": threads}
    gap = None if model is None else np.full(count, np.nan)
    for first in range(0, count, _BLOCK):
        index = np.arange(first, min(first + _BLOCK, count))
        poses = np.tile(np.eye(4), (len(index), 1, 1))
        poses[:, :3, :3] = R[index % len(R)]
        poses[:, :3, 3] = p[index // len(R)]
        found, free, contact = found_free(robot, poses, model, options)
        q[index[free]] = found[free]
        reached[index], touching[index] = free, contact
        quality[index[free]] = manipulability(robot, found[free])
        if gap is not None and model is not None:
            gap[index[free]] = _gaps(robot, model, found[free])
        if progress is not None:
            progress(int(index[-1]) + 1, count)
    shape = (len(p), len(R))
    return ReachMap(
        robot.name or "robot",
        p,
        R,
        reached.reshape(shape),
        touching.reshape(shape),
        q.reshape(*shape, robot.dof),
        quality.reshape(shape),
        None if gap is None else gap.reshape(shape),
    )


def scene_model(robot: Robot, scene: Mapping[str, Any] | Scene | None) -> CollisionModel | None:
    """Return what solutions are checked against; None: nothing is.

    Args:
        robot: The robot.
        scene: As of :func:`reach_map`.
    """
    if scene is None:
        return None
    resolved = resolve_scene(parse(Scene, scene), Path.cwd())
    return requested_model(robot, resolved, {}, ToolFrame(), always=False)


def found_free(
    robot: Robot, poses: Array, model: CollisionModel | None, options: Mapping[str, Any]
) -> tuple[Array, Flags, Flags]:
    """Return solutions, which of them are there and free, and which poses were in contact only.

    Args:
        robot: The robot.
        poses: As of :func:`ikplan.solve_ik_batch`.
        model: What must not touch; None: that is not checked.
        options: For :func:`ikplan.solve_ik_batch`.
    """
    solved = solve_ik_batch(robot, poses, verdict=False, **options)
    q, free = solved.q.copy(), solved.solved.copy()
    touching = np.zeros(len(poses), dtype=np.bool_)
    if model is None or not len(model.pairs) or not free.any():
        return q, free, touching
    from ikplan.collision.checker import CollisionChecker

    checker = CollisionChecker(robot, model)
    touching[free] = ~checker.free(q[free])
    for start in _starts(robot, _BRANCHES - 1):
        again = np.flatnonzero(touching)
        if len(again) == 0:
            break
        other = solve_ik_batch(robot, poses[again], start=start, verdict=False, **options)
        clear = other.solved.copy()
        clear[clear] = checker.free(other.q[clear])
        q[again[clear]] = other.q[clear]
        touching[again[clear]] = False
    return q, free & ~touching, touching


def _starts(robot: Robot, count: int) -> Array:
    """Configurations spread evenly over the limits, shape (count, dof) [rad or m]."""
    lower, upper = arm_of(robot).search_bounds(np.array(robot.home))
    starts = np.empty((count, robot.dof))
    for k in range(count):
        restart_into(k, 0.25, np.array(lower), np.array(upper), starts[k])
    return starts


def manipulability(robot: Robot, q: Array) -> Array:
    """Return the manipulability of configurations, shape (n,); see :class:`ReachMap`."""
    chain = arm_of(robot).chain
    J = np.array([jacobian(chain, row) for row in q]).reshape(len(q), 6, robot.dof)
    return np.asarray(np.linalg.svd(J, compute_uv=False).prod(axis=1))


def _gaps(robot: Robot, model: CollisionModel, q: Array) -> Array:
    """Smallest gap of configurations, shape (n,) [m]."""
    from ikplan.collision.checker import CollisionChecker

    checker = CollisionChecker(robot, model)
    return np.array([checker.least_gap(row)[0] for row in q])
