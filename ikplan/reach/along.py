"""Poses along the path of a request."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import InvalidRequest
from ikplan.path import Pose, ToolLeg, legs_of
from ikplan.robots import Robot

__all__ = ["PathPoses", "poses_along"]


class PathPoses(NamedTuple):
    """Poses along a path, in the base.

    Attributes:
        rotations: Shape (n, 3, 3).
        positions: Shape (n, 3) [m].
        oriented: Whether the orientation is asked for, shape (n,).
    """

    rotations: Array
    positions: Array
    oriented: Flags


def poses_along(request: PlanRequest, robot: Robot, count: int) -> PathPoses:
    """Return poses along the tool paths of a request, evenly by length, the ends included.

    A motion to the path, and motions of the joints between tool paths, are left out. Where the
    request leaves a freedom of orientation, no orientation is asked for.

    Args:
        request: The request.
        robot: Its robot, with its tool.
        count: How many poses.

    Raises:
        InvalidRequest: The path makes no sense, or has no tool path.
    """

    def fk(q: Array) -> tuple[Array, Array]:
        placed = robot.fk(q)
        return placed.rotation, placed.translation

    start = None
    if request.start != "free":
        start = Pose(*fk(robot.home if request.start is None else np.array(request.start)))
    legs = [leg for leg in legs_of(request.path, start, fk) if isinstance(leg, ToolLeg)]
    # The way to the first waypoint is no part of the work.
    begins = [_first(leg) for leg in legs]
    lengths = np.array([leg.path.length - begin for leg, begin in zip(legs, begins, strict=True)])
    if not len(lengths):
        raise InvalidRequest(
            "path: the tool follows nothing, it only goes from joint values to joint values",
            field="path",
            allowed="a path of the tool",
        )
    at = np.linspace(0.0, float(lengths.sum()), count)
    ends = np.cumsum(lengths)
    R, p, oriented = np.empty((count, 3, 3)), np.empty((count, 3)), np.zeros(count, dtype=np.bool_)
    which = np.minimum(np.searchsorted(ends, at, side="left"), len(legs) - 1)
    for k, leg in enumerate(legs):
        mine = which == k
        if mine.any():
            s = begins[k] + np.clip(at[mine] - (ends[k] - lengths[k]), 0.0, lengths[k])
            R[mine], p[mine] = leg.path.poses(s)
            oriented[mine] = leg.path.orientation_mask(s)
    if request.path.orientation_free is not None or request.path.tolerance.box is not None:
        oriented[:] = False
    return PathPoses(R, p, oriented)


def _first(leg: ToolLeg) -> float:
    """Path length of a leg's first waypoint [m]; a path of one waypoint counts as a whole."""
    return float(leg.path.waypoint_s[0]) if len(leg.path.waypoints) > 1 else 0.0
