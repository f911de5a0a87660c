"""How much of a path an arm reaches, wherever the path is shifted to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array, Flags
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene
from ikplan.errors import InvalidRequest
from ikplan.pipeline.resolve import resolve_robot
from ikplan.reach.along import poses_along
from ikplan.reach.reach_map import found_free, manipulability, scene_model
from ikplan.robots import Robot

__all__ = ["PathReach", "path_reach"]

_BLOCK = 8192
"""Poses that are solved together."""
_POSES = 24


@dataclass(frozen=True)
class PathReach:
    """Which poses along a path an arm reaches; m shifts of the path by n poses.

    Attributes:
        robot: Name of the robot.
        positions: How the path is shifted, shape (m, 3) [m].
        reached: Poses with a solution that is free of contact, where that is checked, shape (m, n).
        in_contact: Poses all of whose solutions looked at are in contact, shape (m, n).
        manipulability: As of :class:`~ikplan.reach.reach_map.ReachMap`, shape (m, n), NaN where a
            pose is not reached.
    """

    robot: str
    positions: Array
    reached: Flags
    in_contact: Flags
    manipulability: Array

    @property
    def share(self) -> Array:
        """Share of the poses that are reached at each shift, shape (m,)."""
        return np.asarray(self.reached.mean(axis=1))


def path_reach(
    request: Mapping[str, Any] | PlanRequest,
    shifts: ArrayLike,
    *,
    robot: Robot | None = None,
    scene: Mapping[str, Any] | Scene | None = None,
    poses: int = _POSES,
    seed: int = 0,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> PathReach:
    """Find out how much of a path an arm reaches at each shift of it.

    Every pose is looked at for itself: a path whose poses are all reached may still have no
    continuous motion (:func:`ikplan.place` asks the planner). Where a freedom of orientation is
    left, positions are looked at only.

    Args:
        request: The request for a plan along the path.
        shifts: How the path is shifted in the base, shape (m, 3) [m].
        robot: The robot, for one that is not in the catalogue.
        scene: What must not be touched; it is not shifted. ``{}``: the arm itself only; None: that
            of the request.
        poses: Poses along the path, evenly by length.
        seed: Seed of the solver's restarts.
        threads: Largest number of threads; None: one a processor.
        progress: Is called with the number of poses done and of all.

    Returns:
        The map; it does not depend on the number of threads.

    Raises:
        InvalidRequest: The request or an argument is wrong, or the path has no tool path.
    """
    if poses < 2:
        raise InvalidRequest("poses: must be 2 or more", field="poses", allowed="2 or more")
    parsed = parse(PlanRequest, request)
    arm = resolve_robot(parsed, robot)
    along = poses_along(parsed, arm, poses)
    given = parsed.scene if scene is None else scene
    if isinstance(given, str):
        raise InvalidRequest("scene: must be the scene itself, not an id", field="scene")
    model = scene_model(arm, given)
    p = np.array(shifts, dtype=np.float64).reshape(-1, 3)
    count = len(p) * poses
    reached, touching = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    quality = np.full(count, np.nan)
    options: dict[str, Any] = {"seed": seed, "threads": threads}
    for first in range(0, count, _BLOCK):
        index = np.arange(first, min(first + _BLOCK, count))
        row, shift = index % poses, index // poses
        places = along.positions[row] + p[shift]
        for oriented in (True, False):
            mine = along.oriented[row] == oriented
            if not mine.any():
                continue
            asked = places[mine]
            if oriented:
                asked = np.tile(np.eye(4), (int(mine.sum()), 1, 1))
                asked[:, :3, :3] = along.rotations[row[mine]]
                asked[:, :3, 3] = places[mine]
            q, free, contact = found_free(arm, asked, model, options)
            reached[index[mine]], touching[index[mine]] = free, contact
            quality[index[mine][free]] = manipulability(arm, q[free])
        if progress is not None:
            progress(int(index[-1]) + 1, count)
    shape = (len(p), poses)
    return PathReach(
        arm.name or "robot",
        p,
        reached.reshape(shape),
        touching.reshape(shape),
        quality.reshape(shape),
    )
