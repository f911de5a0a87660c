"""The shortest jerk-limited motion over a straight distance, from rest to rest, in closed form."""

from __future__ import annotations

import math

import numpy as np

from ikplan.timing.jerk.cubic_motion import CubicMotion

__all__ = ["double_s", "double_s_duration"]


def double_s(
    distance: float, velocity: float, acceleration: float, deceleration: float, jerk: float
) -> CubicMotion:
    """Return the double-S profile: at most seven phases of constant jerk.

    The speed rises to a peak and falls back, both as fast as the limits allow, with a phase at
    the velocity limit between where the distance is long enough. Each half is a ramp of the
    acceleration up, a phase at its limit and a ramp down; Biagiotti and Melchiorri, Trajectory
    Planning for Automatic Machines and Robots (2008), section 3.4.

    Args:
        distance: Distance to go, > 0.
        velocity: Velocity limit, > 0; may be inf.
        acceleration: Limit of the acceleration while the speed rises, > 0; may be inf.
        deceleration: Limit of its absolute value while the speed falls, > 0; may be inf.
        jerk: Jerk limit, both ways, > 0, finite.

    Returns:
        The motion, its nodes at the switches of the jerk.
    """
    peak = _peak(distance, velocity, acceleration, deceleration, jerk)
    up, down = _ramp(peak, acceleration, jerk), _ramp(peak, deceleration, jerk)
    way = 0.5 * peak * (2.0 * up[0] + up[1] + 2.0 * down[0] + down[1])
    cruise = max(distance - way, 0.0) / peak
    phases = [up[0], up[1], up[0], cruise, down[0], down[1], down[0]]
    signs = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0]
    time, s, v, a = [0.0], [0.0], [0.0], [0.0]
    least = 1e-12 * sum(phases)
    for dt, sign in zip(phases, signs, strict=True):
        if dt <= least:
            continue
        j = sign * jerk
        s.append(s[-1] + dt * (v[-1] + dt * (0.5 * a[-1] + dt * j / 6.0)))
        v.append(max(v[-1] + dt * (a[-1] + 0.5 * dt * j), 0.0))
        a.append(a[-1] + dt * j if sign else a[-1])
        time.append(time[-1] + dt)
    s[-1], v[-1], a[-1] = distance, 0.0, 0.0
    return CubicMotion(np.array(time), np.minimum(s, distance), np.array(v), np.array(a))


def double_s_duration(
    distance: float, velocity: float, acceleration: float, deceleration: float, jerk: float
) -> float:
    """Return the duration of the double-S profile [s]; arguments as of :func:`double_s`."""
    peak = _peak(distance, velocity, acceleration, deceleration, jerk)
    up, down = _ramp(peak, acceleration, jerk), _ramp(peak, deceleration, jerk)
    turning = 2.0 * up[0] + up[1] + 2.0 * down[0] + down[1]
    return turning + max(distance - 0.5 * peak * turning, 0.0) / peak


def _ramp(peak: float, limit: float, jerk: float) -> tuple[float, float]:
    """Return how long the jerk and how long the acceleration is at its limit up to a speed."""
    if peak * jerk >= limit * limit:
        return limit / jerk, max(peak / limit - limit / jerk, 0.0)
    return math.sqrt(peak / jerk), 0.0


def _peak(
    distance: float, velocity: float, acceleration: float, deceleration: float, jerk: float
) -> float:
    """Return the greatest speed: the limit, or that from which the way back to rest is just left.

    The way is 0.5 peak (up + down), up and down the durations of both halves: where the
    acceleration limit is reached, peak / a + a / j; else 2 sqrt(peak / j).
    """
    low, high = min(acceleration, deceleration), max(acceleration, deceleration)
    # Neither limit is reached: 2 peak sqrt(peak / j) = distance.
    peak = math.pow(0.5 * distance * math.sqrt(jerk), 2.0 / 3.0)
    if peak * jerk > low * low:
        # The lower one is: 0.5 peak (peak / low + low / j + 2 sqrt(peak / j)) = distance.
        peak = _root(distance, low, jerk, peak)
        if peak * jerk > high * high:
            # Both are: a quadratic in the peak, (1 / low + 1 / high) / 2, (low + high) / (2 j).
            square, linear = 0.5 * (1.0 / low + 1.0 / high), 0.5 * (low + high) / jerk
            root = math.sqrt(linear * linear + 4.0 * square * distance)
            peak = 2.0 * distance / (linear + root)
    return min(peak, velocity)


def _root(distance: float, low: float, jerk: float, start: float) -> float:
    """Return the peak of a motion with one half at its acceleration limit, by Newton's steps.

    In r = sqrt(peak) the way is r^4 / (2 low) + r^2 low / (2 j) + r^3 / sqrt(j): convex and
    rising, so that Newton's steps from above descend to the root.
    """
    r, k = math.sqrt(start), math.sqrt(jerk)
    while True:
        way = r * r * (0.5 * r * r / low + 0.5 * low / jerk + r / k)
        slope = r * (2.0 * r * r / low + low / jerk + 3.0 * r / k)
        following = r - (way - distance) / slope
        if not following < r * (1.0 - 1e-16):
            return min(r, following) * min(r, following)
        r = following
