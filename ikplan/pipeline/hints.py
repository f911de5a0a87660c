"""What takes time and need not, in words."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.certificate import Certificate
from ikplan.documents.limits import LimitOptions
from ikplan.documents.path import PathRequest
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot
from ikplan.robots.definition.assumptions import is_assumed

__all__ = ["default_hints", "noise_hints", "segment_hints", "stop_hints"]


_ACCELERATIONS = ("acceleration", "acceleration_lower", "deceleration")
_FEW = 50
"""Fewer waypoints than this are no recording."""
_OFTEN = 0.2
"""Share of the rows in which the acceleration of a noisy joint reverses."""
_SMALL = 0.01
"""Noise is small beside the motion: at most this share of it."""
_ROUNDING = 1e-9
"""What numbers are off by rounding [rad or m]."""


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


def stop_hints(
    certificate: Certificate, path: PathRequest | None, asked: PathRequest | None = None
) -> list[str]:
    """Say that a motion stops on its way, and which field lets it go on.

    Args:
        certificate: The certificate of the motion.
        path: The path that the motion follows; None: the waypoints are joint values.
        asked: The path of the request, where the motion stops at corners with a blend; None: it is
            the same.
    """
    count = len(certificate.stops)
    if path is None or count == 0:
        return []
    times = "once" if count == 1 else f"{count} times"
    first = f"the motion stops {times} between its ends, first at {certificate.stops[0]:.4g} s"
    if asked is not None and asked != path:
        return [f"{first}: stopping at the corners is faster than going through their blends"]
    exact = path.corners == "exact" or path.blend == 0.0
    change = "path.blend, a radius"
    if exact:
        change += ', or path.corners "tolerance" without a blend'
    return [f"{first}: {change}, rounds corners, which are then passed without a stop"]


def noise_hints(robot: Robot, rows: Array, times: Array) -> list[str]:
    """Say that waypoints are noisy, how much, and what share of the time is spent on it.

    Noise turns the acceleration of a joint to and fro from row to row, by steps that are small
    beside its motion.

    Args:
        robot: The robot.
        rows: Joint waypoints, shape (n, dof) [rad or m].
        times: When each is passed, shape (n,) [s].
    """
    if len(rows) < _FEW:
        return []
    second = np.diff(rows, n=2, axis=0)
    size = np.minimum(np.abs(second[1:]), np.abs(second[:-1]))
    back = (second[1:] * second[:-1] < 0.0) & (size > _ROUNDING)
    most = _SMALL * float(np.ptp(rows, axis=0).max())
    count = back.sum(axis=0)
    noisy = [
        j
        for j in np.flatnonzero(count > _OFTEN * len(rows))
        if float(np.median(size[back[:, j], j])) < most
    ]
    if not noisy:
        return []
    spent = np.diff(times)[1:-1]
    share = float((spent * back[:, noisy].any(axis=1)).sum() / max(float(times[-1]), 1e-300))
    # The second difference of independent errors is about 2.4 times as large as they are.
    noise = max(float(np.median(size[back[:, j], j])) for j in noisy) / 2.4
    names = ", ".join(f"{robot.joint_names[j]} {count[j]}" for j in noisy)
    return [
        f"the waypoints are noisy: in {len(rows)} rows the accelerations of joints reverse "
        f"({names} times) by noise of about {noise:.1g} rad or m, during {100.0 * share:.0f} % of "
        f"the time; with `tolerance`, such as {5.0 * noise:.1g}, the motion takes a smooth path "
        "past it"
    ]
