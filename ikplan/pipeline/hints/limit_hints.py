"""Where accelerations asked for are above what holds, in words."""

from __future__ import annotations

import numpy as np

from ikplan.documents.limits import LimitOptions
from ikplan.documents.path import PathRequest
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot
from ikplan.robots.definition.assumptions import is_assumed

__all__ = ["default_hints", "segment_hints"]


_ACCELERATIONS = ("acceleration", "acceleration_lower", "deceleration")


def default_hints(robot: Robot, limits: LimitOptions) -> list[str]:
    """Say where an acceleration that is asked for is above a limit of the robot, which holds.

    One that is only a default, given by no source, does not hold then: what is asked for does.

    Args:
        robot: The robot.
        limits: The limits asked for.
    """
    own = robot.acceleration_limit
    assumptions = robot.description.assumptions
    said = []
    for field in _ACCELERATIONS:
        value = getattr(limits, field)
        if value is None:
            continue
        above = np.abs(np.broadcast_to(np.array(value), own.shape)) > own
        names = [robot.joint_names[j] for j in np.flatnonzero(above)]
        firm = [name for name in names if not is_assumed(assumptions, "acceleration", name)]
        if firm:
            rates = ", ".join(f"{n} {own[robot.joint_names.index(n)]:.4g}" for n in firm)
            said.append(
                f"limits.{field} is above the robot's limits of {rates} rad/s^2 or m/s^2, which "
                "hold, since a source gives them: load_robot(limits=...) or an upload gives the "
                "robot others"
            )
    return said


def segment_hints(
    robot: Robot, asked: LimitOptions, limits: MotionLimits, path: PathRequest | None
) -> list[str]:
    """Say where an acceleration of a segment is above that of the whole path, which holds there.

    Args:
        robot: The robot.
        asked: The limits asked for, for the whole path.
        limits: What these and the robot's own come to.
        path: The path of the request; None: there are no segments.
    """
    up, down = limits.acceleration, -limits.acceleration_lower
    slowing = np.minimum(up, down) if limits.deceleration is None else limits.deceleration
    said = []
    for field, held in zip(_ACCELERATIONS, (up, down, slowing), strict=True):
        above = []
        for k, segment in enumerate((path and path.segments) or ()):
            value = segment.limits and getattr(segment.limits, field)
            if value and (np.abs(np.broadcast_to(np.array(value), held.shape)) > held).any():
                above.append(f"path.segments[{k}].limits.{field}")
        if above:
            more = f" and of {len(above) - 1} more segments" if len(above) > 1 else ""
            rates = ", ".join(
                f"{name} {rate:.4g}" for name, rate in zip(robot.joint_names, held, strict=True)
            )
            given = getattr(asked, field) is not None
            said.append(
                f"{above[0]}{more} is above what holds for the whole path: {rates} rad/s^2 or "
                f"m/s^2; limits of segments only lower it, limits.{field} "
                + ("says it" if given else "replaces what is only a named default")
            )
    return said
