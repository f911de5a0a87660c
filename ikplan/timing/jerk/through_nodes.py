"""Motions with given places and accelerations at nodes, and constant path jerk between them."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["through_nodes"]

_STEPS = 30


@kernel
def _half(s: Array, a: Array, dt: Array, v: Array) -> bool:
    """Go from rest through nodes; write durations and speeds.

    With the acceleration linear in an interval, the way v0 dt + (2 a0 + a1) dt^2 / 6 is a
    quadratic in its duration.
    """
    v[0] = 0.0
    for i in range(len(s) - 1):
        way = s[i + 1] - s[i]
        square = v[i] * v[i] + way * (2.0 * a[i] + a[i + 1]) / 1.5
        if not square > 0.0:
            return False
        dt[i] = 2.0 * way / (v[i] + np.sqrt(square))
        v[i + 1] = v[i] + 0.5 * (a[i] + a[i + 1]) * dt[i]
        if not v[i + 1] > 0.0:
            return False
    return True


@kernel
def through_nodes(
    s: Array, a: Array, bump: Array, middle: int
) -> tuple[Array, Array, Array, Array]:
    """Return the motion from rest to rest through nodes.

    It is built from both ends, so that it is at rest there; the halves meet at the same speed
    once the accelerations have been changed by a multiple of a bump.

    Args:
        s: Path positions of the nodes, shape (n + 1,), strictly increasing.
        a: Path accelerations there, shape (n + 1,); those at the ends are taken to be zero.
        bump: By what they may be changed, shape (n + 1,), zero at both ends, else positive.
        middle: Where the halves meet, from 1 to n - 1.

    Returns:
        Times, path positions, velocities and accelerations; times of NaN: there is none.
    """
    n = len(s) - 1
    dt, v = np.empty(n), np.empty(n + 1)
    rear_dt, rear_v = np.empty(n - middle), np.empty(n - middle + 1)
    rear_s = (s[n] - s[middle:])[::-1].copy()
    share, miss, other, known = 0.0, 0.0, 0.0, False
    here = a.copy()
    for step in range(_STEPS):
        here = a + share * bump
        here[0], here[n] = 0.0, 0.0
        rear_a = -here[middle:][::-1].copy()
        if not (
            _half(s[: middle + 1], here[: middle + 1], dt, v)
            and _half(rear_s, rear_a, rear_dt, rear_v)
        ):
            return np.full(n + 1, np.nan), s, v, here
        speed = v[middle]
        new = speed - rear_v[n - middle]
        if abs(new) <= 1e-13 * speed:
            break
        following = share
        if known and new != miss:
            following = share - new * (share - other) / (new - miss)
        else:
            # The bump changes both speeds by about its area.
            area = 0.0
            for i in range(middle):
                area += 0.5 * dt[i] * (bump[i] + bump[i + 1])
            for i in range(n - middle):
                area += 0.5 * rear_dt[i] * (bump[n - i] + bump[n - i - 1])
            following = share - new / area
        miss, other, known = new, share, True
        if following == share:
            break
        share = following
        if step == _STEPS - 1:
            return np.full(n + 1, np.nan), s, v, here
    time = np.zeros(n + 1)
    for i in range(n):
        if i >= middle:
            dt[i] = rear_dt[n - 1 - i]
            v[i + 1] = rear_v[n - 1 - i]
        time[i + 1] = time[i] + dt[i]
    return time, s, v, here
