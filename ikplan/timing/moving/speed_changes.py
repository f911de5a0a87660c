"""Changes of a path speed with limited acceleration and jerk, in closed form, and their sums."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.timing.jerk.cubic_motion import CubicMotion

__all__ = ["brake", "reversed_motion", "steady", "sum_of"]

_APART = 1e-10
"""Nodes nearer than this share of the duration are one."""
_ROUNDING = 1e-12


def brake(speed: float, pull: float, acceleration: float, jerk: float) -> CubicMotion | None:
    """Return the shortest motion from a speed to rest.

    At most three phases: the deceleration builds up, is at its limit, and fades.

    Args:
        speed: Path speed at the beginning, >= 0.
        pull: Path acceleration at the beginning.
        acceleration: Limit of the deceleration, > 0.
        jerk: Limit of the jerk, > 0, finite.

    Returns:
        The motion; None: the deceleration at the beginning is so high that it cannot fade before
        the motion turns back.
    """
    square = jerk * speed + 0.5 * pull * pull
    peak = min(math.sqrt(square), acceleration)
    if pull < -peak * (1.0 + _ROUNDING):
        return None
    build = max((pull + peak) / jerk, 0.0)
    hold = 0.0
    if peak > 0.0:
        left = speed + (pull * pull - 2.0 * peak * peak) / (2.0 * jerk)
        hold = max(left / peak, 0.0)
    fade = peak / jerk
    time, s, v, a = [0.0], [0.0], [speed], [pull]
    least = _ROUNDING * (build + hold + fade)
    for dt, j in ((build, -jerk), (hold, 0.0), (fade, jerk)):
        if dt <= least:
            continue
        s.append(s[-1] + dt * (v[-1] + dt * (0.5 * a[-1] + dt * j / 6.0)))
        v.append(max(v[-1] + dt * (a[-1] + 0.5 * dt * j), 0.0))
        a.append(a[-1] + dt * j)
        time.append(time[-1] + dt)
    v[-1], a[-1] = 0.0, 0.0
    if len(time) == 1:
        return None if speed > 0.0 else CubicMotion(*(np.zeros(1) for _ in range(4)))
    return CubicMotion(np.array(time), np.array(s), np.array(v), np.array(a))


def reversed_motion(motion: CubicMotion) -> CubicMotion:
    """Return a motion backwards in time: what braked sets out."""
    return CubicMotion(
        (motion.time[-1] - motion.time)[::-1].copy(),
        (motion.s[-1] - motion.s)[::-1].copy(),
        motion.v[::-1].copy(),
        -motion.a[::-1],
    )


def steady(speed: float, duration: float) -> CubicMotion:
    """Return a motion at constant speed."""
    return CubicMotion(
        np.array([0.0, duration]),
        np.array([0.0, speed * duration]),
        np.array([speed, speed]),
        np.zeros(2),
    )


def sum_of(parts: Sequence[tuple[float, CubicMotion]], start: float, end: float) -> CubicMotion:
    """Return the sum of motions along one path.

    Args:
        parts: When each begins [s], and the motion; before and after, it stands.
        start: Path position at the beginning.
        end: Path position at the end, which the sum arrives at but for rounding.

    Returns:
        The motion. A part that moves at its own end has to end with the sum.
    """
    nodes = np.unique(np.concatenate([begin + part.time for begin, part in parts]))
    last = float(nodes[-1])
    kept = [nodes[0]]
    for time in nodes[1:-1]:
        if min(time - kept[-1], last - time) > _APART * last:
            kept.append(time)
    time = np.array([*kept, last])
    s, v, a = np.full(len(time), start), np.zeros(len(time)), np.zeros(len(time))
    for begin, part in parts:
        at = time - begin
        before, after = at < 0.0, at > part.time[-1] * (1.0 + _APART) + _APART * last
        places, speeds, pulls = _at(part, np.clip(at, 0.0, part.time[-1]))
        s += places
        v += np.where(before | after, 0.0, speeds)
        a += np.where(before | after, 0.0, pulls)
    s = np.minimum(np.maximum.accumulate(s), end)
    s[-1] = end
    return CubicMotion(time, s, np.maximum(v, 0.0), a)


def _at(part: CubicMotion, times: Array) -> tuple[Array, Array, Array]:
    if len(part.time) == 1:
        return np.zeros(len(times)), np.zeros(len(times)), np.zeros(len(times))
    return part.at(times)
