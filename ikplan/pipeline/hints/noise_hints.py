"""Whether waypoints are noisy, how much, and what passes their noise smoothly, in words."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.documents.path import PathRequest
from ikplan.robots import Robot

__all__ = ["joint_noise_hints", "path_noise_hints"]


_FEW = 50
"""Fewer waypoints than this are no recording."""
_OFTEN = 0.2
"""Share of the rows in which the acceleration of a noisy column reverses."""
_SMALL = 0.01
"""Noise is small beside the motion: at most this share of it."""
_TURNED = 0.01
"""Rates that turn to and fro by less than this share of the largest cost little time."""
_ROUNDING = 1e-9
"""What numbers are off by rounding [rad or m]."""
_SECOND = 2.4
"""How many times as large as independent errors their second difference is, about."""
_ENOUGH, _ENOUGH_OF_TOOL = 5.0, 10.0
"""How many times the noise a tolerance of each joint, or of the tool in all directions, is."""


class _Noise(NamedTuple):
    """What of rows is noise.

    Attributes:
        reversals: How often each column's acceleration reverses, of those that are noisy.
        rows: In which rows one of them does, shape (n - 3,).
        size: How large the noise is.
    """

    reversals: dict[int, int]
    rows: Flags
    size: float


def joint_noise_hints(robot: Robot, rows: Array, times: Array) -> list[str]:
    """Say that joint waypoints are noisy, how much, and what share of the time is spent on it.

    Noise turns the acceleration of a joint to and fro from row to row, by steps that are small
    beside its motion.

    Args:
        robot: The robot.
        rows: Joint waypoints, shape (n, dof) [rad or m].
        times: When each is passed, shape (n,) [s].
    """
    noise = _noise_of(rows)
    if noise is None:
        return []
    names = ", ".join(f"{robot.joint_names[j]} {n}" for j, n in noise.reversals.items())
    return [
        f"the waypoints are noisy: in {len(rows)} rows the accelerations of joints reverse "
        f"({names} times) by noise of about {noise.size:.1g} rad or m, during "
        f"{100.0 * _share(noise, times):.0f} % of the time; with `tolerance`, such as "
        f"{_ENOUGH * noise.size:.1g}, the motion takes a smooth path past it"
    ]


def path_noise_hints(path: PathRequest | None, q: Array, times: Array) -> list[str]:
    """Say that a motion follows noise of the waypoints of a tool path.

    Args:
        path: The path; None: the waypoints are joint values.
        q: Configurations at the waypoints, shape (n, dof) [rad or m].
        times: When each is passed, shape (n,) [s].
    """
    if path is None or path.interpolation == "joint" or len(path.waypoints or ()) < _FEW:
        return []
    asked = _noise_of(np.array([pose.position for pose in path.waypoints or ()]))
    followed = _following(q, times)
    if asked is None or followed == 0.0:
        return []
    tolerance = _ENOUGH_OF_TOOL * asked.size
    line = "" if path.interpolation == "line" else '`path.interpolation` "line" and '
    return [
        f"the waypoints are noisy, by about {asked.size:.1g} m, and the motion follows the noise "
        f"during {100.0 * followed:.0f} % of the time; with {line}`path.tolerance.position`, such "
        f"as {tolerance:.1g}, it takes a smooth path past it"
    ]


def _noise_of(rows: Array) -> _Noise | None:
    """What of rows, shape (n, d), is noise; None: nothing."""
    if len(rows) < _FEW:
        return None
    second = np.diff(rows, n=2, axis=0)
    size = np.minimum(np.abs(second[1:]), np.abs(second[:-1]))
    back = (second[1:] * second[:-1] < 0.0) & (size > _ROUNDING)
    most = _SMALL * float(np.ptp(rows, axis=0).max())
    count = back.sum(axis=0)
    noisy = [
        int(j)
        for j in np.flatnonzero(count > _OFTEN * len(rows))
        if float(np.median(size[back[:, j], j])) < most
    ]
    if not noisy:
        return None
    largest = max(float(np.median(size[back[:, j], j])) for j in noisy)
    reversals = {j: int(count[j]) for j in noisy}
    return _Noise(reversals, np.asarray(back[:, noisy].any(axis=1)), largest / _SECOND)


def _following(q: Array, times: Array) -> float:
    """Share of the time in which rates turn to and fro from waypoint to waypoint; 0 if seldom.

    Waypoints are passed at other distances than they are apart, so that it takes their times.
    """
    passed = np.append(True, np.diff(times) > 0.0)
    q, times = q[passed], times[passed]
    if len(q) < _FEW:
        return 0.0
    rates = np.diff(q, axis=0) / np.diff(times)[:, None]
    change = np.diff(rates, axis=0)
    least = _TURNED * float(np.abs(rates).max())
    size = np.minimum(np.abs(change[1:]), np.abs(change[:-1]))
    back = (change[1:] * change[:-1] < 0.0) & (size > least)
    if back.sum(axis=0).max() <= _OFTEN * len(q):
        return 0.0
    return float((np.diff(times)[1:-1] * back.any(axis=1)).sum() / times[-1])


def _share(noise: _Noise, times: Array) -> float:
    """Share of the time that is spent on noise."""
    spent = np.diff(times)[1:-1]
    return float((spent * noise.rows).sum() / max(float(times[-1]), 1e-300))
