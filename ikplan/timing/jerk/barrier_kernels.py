"""The barrier that keeps a motion played at another speed inside its limits, compiled."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.timing.jerk.barrier_lanes import (
    B1,
    B2,
    BLOCK,
    DW,
    HUGE,
    JERK,
    OUTSIDE,
    PRODUCT,
    ROWS,
    S0,
    TINY,
    TOP,
    WILD,
    B,
    SpeedSpline,
    W,
    WarpLimits,
    joint_excess,
    joint_room,
    joint_ways,
    row_excess,
    row_room,
    row_ways,
    speeds,
)

__all__ = ["excess_of", "longest_step", "time_and_room"]

# How much of the way to the limits a step may go.
_WAY = 0.98


@kernel
def time_and_room(c: Array, spline: SpeedSpline, limits: WarpLimits) -> tuple[float, float]:
    """Return the time, and the logarithms of the room to the limits; outside them inf and 0.

    The merit is the time less mu times the other.
    """
    total, room = 0.0, 0.0
    n = len(spline.h)
    work = np.empty((2, ROWS * BLOCK))
    for i in range(0, n, BLOCK):
        size = min(BLOCK, n - i)
        for k in range(2):
            speeds(spline, c, k, i, work, B)
            s, most = work[k], limits.most[k, i : i + size]
            for t in range(size):
                b, product = s[B + t], 1.0 - s[B + t] / most[t]
                s[W + t], s[PRODUCT + t] = 1.0 / np.sqrt(b), product
                s[OUTSIDE + t] = 0.0 if (b > 0.0) & (product > 0.0) else 1.0
                s[WILD + t] = 0.0
            joint_room(limits, k, i, work)
            row_room(limits, k, i, work)
            if s[OUTSIDE : OUTSIDE + size].sum() > 0.0:
                return np.inf, 0.0
        for t in range(size):
            for k in range(2):
                s = work[k]
                total += 0.5 * spline.h[i + t] * s[W + t]
                if s[WILD + t] > 0.0:
                    speed = s[B + t], s[B1 + t], s[B2 + t], s[W + t]
                    room = _room_apart(room, speed, limits, k, i + t)
                else:
                    room += np.log(s[PRODUCT + t])
    return total, room


@kernel
def _room_apart(
    room: float, speed: tuple[float, float, float, float], limits: WarpLimits, k: int, i: int
) -> float:
    """Add the logarithms of the room at one point, of a product that would overflow in parts."""
    b, b1, b2, w = speed
    product = 1.0 - b / limits.most[k, i]
    for j in range(limits.rates.shape[1]):
        d0, d1, e0, e1, e2 = limits.rates[k, j, :, i]
        pull, jerk = d0 * b + d1 * b1, e0 * b + e1 * b1 + e2 * b2
        product *= (1.0 - pull * limits.up[k, j, i]) * (1.0 - pull * limits.down[k, j, i])
        product *= w * w - jerk * jerk
        if not TINY < product < HUGE:
            room += np.log(product)
            product = 1.0
    for r in range(limits.rows_b.shape[1]):
        product *= 1.0 - limits.rows_b[k, r, i] * b - limits.rows_d[k, r, i] * b1
        if product < TINY:
            room += np.log(product)
            product = 1.0
    return float(room + np.log(product))


@kernel
def longest_step(c: Array, step: Array, spline: SpeedSpline, limits: WarpLimits) -> float:
    """Return how much of a step keeps inside the limits, at most 1.

    The room to a jerk limit is taken along its tangent, below which it does not fall.
    """
    largest = 0.0
    n = len(spline.h)
    work = np.empty((2, ROWS * BLOCK))
    for i in range(0, n, BLOCK):
        size = min(BLOCK, n - i)
        for k in range(2):
            speeds(spline, c, k, i, work, B)
            speeds(spline, step, k, i, work, S0)
            s, most = work[k], limits.most[k, i : i + size]
            for t in range(size):
                b, change = s[B + t], s[S0 + t]
                w = 1.0 / np.sqrt(b)
                s[W + t], s[DW + t] = w, -0.5 * w / b * change
                s[TOP + t] = max(-change / b, change / (most[t] - b))
            joint_ways(limits, k, i, work)
            row_ways(limits, k, i, work)
            largest = max(largest, s[TOP : TOP + size].max())
    return min(1.0, _WAY / largest) if largest > 0.0 else 1.0


@kernel
def excess_of(c: Array, spline: SpeedSpline, limits: WarpLimits) -> Array:
    """Return by what factor the squared speed is too high, interval by interval, shape (n,)."""
    n = len(spline.h)
    found = np.zeros(n)
    work = np.empty((2, ROWS * BLOCK))
    for i in range(0, n, BLOCK):
        size = min(BLOCK, n - i)
        for k in range(2):
            speeds(spline, c, k, i, work, B)
            s, most = work[k], limits.most[k, i : i + size]
            for t in range(size):
                s[TOP + t], s[JERK + t] = s[B + t] / most[t], 0.0
            joint_excess(limits, k, i, work)
            row_excess(limits, k, i, work)
            for t in range(size):
                b = s[B + t]
                largest = max(s[TOP + t], np.cbrt(np.square(s[JERK + t]) * b))
                found[i + t] = max(found[i + t], largest) if b > 0.0 else np.inf
    return found
