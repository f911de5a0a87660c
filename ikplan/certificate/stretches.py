"""Part of the certificate: limits that hold on stretches of a motion only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.limits import RATIO_SLACK, further_limits
from ikplan.motion_limits import MotionLimits
from ikplan.result import LimitPlace, SegmentCertificate
from ikplan.robots import Robot

__all__ = ["LimitWindow", "stretch_checks"]

Array = NDArray[np.float64]

# A sample this near to the end of a window, as a share of the duration, is of the next stretch.
_EDGE = 1e-9


@dataclass(frozen=True, eq=False)
class LimitWindow:
    """Limits that hold between two times.

    Attributes:
        field: What of the request asks for them.
        begin: When they begin [s].
        end: When they end [s].
        limits: All that the motion has to keep there.
    """

    field: str
    begin: float
    end: float
    limits: MotionLimits


def stretch_checks(
    robot: Robot, windows: Sequence[LimitWindow], time: Array, q: Array, dq: Array, ddq: Array
) -> tuple[list[SegmentCertificate], list[str]]:
    """Measure what a motion uses of the limits of its stretches.

    Args:
        robot: The robot, with its tool.
        windows: The limits, and when they hold.
        time: Sample times, shape (m,) [s].
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).

    Returns:
        Their part of the certificate, and which limits are exceeded, in words.
    """
    found, exceeded = [], []
    edge = _EDGE * float(time[-1])
    for window in windows:
        inside = (time > window.begin + edge) & (time < window.end - edge)
        # The samples at rest are of the first and of the last stretch.
        inside[0] |= window.begin <= 0.0
        inside[-1] |= window.end >= time[-1] - edge
        part = _measured(robot, window, time[inside], q[inside], dq[inside], ddq[inside])
        found.append(part[0])
        exceeded += [f"{window.field}: {words}" for words in part[1]]
    return found, exceeded


def _measured(
    robot: Robot, window: LimitWindow, time: Array, q: Array, dq: Array, ddq: Array
) -> tuple[SegmentCertificate, list[str]]:
    limits = window.limits
    certificate = SegmentCertificate(field=window.field, begin=window.begin, end=window.end)
    if len(time) == 0:
        return certificate, []
    measured, exceeded = further_limits(robot, limits, time, q, dq, ddq)
    for kind, ratios in (
        ("velocity", np.maximum(dq / limits.velocity, dq / limits.velocity_lower)),
        ("acceleration", np.maximum(ddq / limits.acceleration, ddq / limits.acceleration_lower)),
    ):
        row, joint = np.unravel_index(int(np.argmax(ratios)), ratios.shape)
        place = LimitPlace(joint=robot.joint_names[joint], time=float(time[row]))
        measured[f"{kind}_limit_ratio"] = float(ratios[row, joint])
        measured[f"{kind}_limit_at"] = place
        if not ratios[row, joint] <= 1.0 + RATIO_SLACK:
            exceeded.append(f"the {kind} limit of {place.joint} is exceeded at {place.time:.4f} s")
    known = {key: value for key, value in measured.items() if key != "jerk_limited"}
    return certificate.model_copy(update=known), exceeded
