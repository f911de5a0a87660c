"""Joints whose limits are 0: they must not move."""

from __future__ import annotations

import numpy as np

from ikplan.errors import InvalidRequest
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import STILL, MotionLimits
from ikplan.robots import Robot

__all__ = ["refuse_moving"]


_STANDS = 1e-9
"""A joint that stays within this does not move [rad or m]."""


def refuse_moving(
    robot: Robot, path: JointPath, limits: MotionLimits, start: float, end: float
) -> None:
    """Refuse a path that moves a joint whose velocity, acceleration or jerk limit is 0.

    Args:
        robot: The robot.
        path: The path.
        limits: The limits of a part of it.
        start: Path position at which the part begins.
        end: Where it ends.

    Raises:
        InvalidRequest: Names the joint and how far it moves.
    """
    asked = {name: getattr(limits, name) for name in ("velocity", "acceleration", "jerk")}
    still = {name: limit <= STILL for name, limit in asked.items() if limit is not None}
    if not any(joints.any() for joints in still.values()):
        return
    inside = path.s_knots[(path.s_knots > start) & (path.s_knots < end)]
    travel = np.ptp(path(np.concatenate([[start], inside, [end]])), axis=0)
    for name, joints in still.items():
        moving = np.flatnonzero(joints & (travel > _STANDS))
        if len(moving):
            j = int(moving[0])
            raise InvalidRequest(
                f"limits.{name}: {robot.joint_names[j]} has the limit 0 and moves by "
                f"{travel[j]:.6g}",
                field=f"limits.{name}",
                allowed="0 of a joint that does not move, else a positive number",
            )
