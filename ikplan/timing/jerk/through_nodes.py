"""Motions with given places and accelerations at nodes, and constant path jerk between them."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices

__all__ = ["slow_nodes", "through_nodes"]

_STEPS = 30
# A local minimum of the speed is slow where it is below this share of the maxima beside it.
_SLOW = 0.7


@kernel
def slow_nodes(v: Array) -> Indices:
    """Return the nodes at which a motion is much slower than before and after, and both ends.

    Args:
        v: Path velocities, shape (n + 1,).

    Returns:
        Indices, rising, at least one node between any two of them, shape (k + 1,).
    """
    n = len(v) - 1
    found = np.empty(n + 1, np.int64)
    found[0] = 0
    count, low, high = 1, 0, 0
    # Up to a maximum, then down to the minimum before the speed rises again by as much.
    for i in range(1, n + 1):
        if low <= high:
            if v[i] > v[high]:
                high = i
            elif v[i] < _SLOW * v[high]:
                low = i
        elif v[i] < v[low]:
            low = i
        elif v[low] < _SLOW * v[i]:
            if found[count - 1] < high < low < n - 1:
                found[count] = low
                count += 1
            high = i
    found[count] = n
    return found[: count + 1].copy()


@kernel
def _half(s: Array, a: Array, dt: Array, v: Array) -> bool:
    """Go on from a speed through nodes; write durations and speeds.

    With the acceleration linear in an interval, the way v0 dt + (2 a0 + a1) dt^2 / 6 is a
    quadratic in its duration.
    """
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
def _part(s: Array, a: Array, bump: Array, middle: int, dt: Array, v: Array) -> bool:
    """Go through nodes between two speeds, v[0] and v[-1]; write durations, speeds, a.

    The motion is built from both ends; the halves meet at the same speed once the accelerations
    have been changed by a multiple of the bump.
    """
    n = len(s) - 1
    first = a.copy()
    rear_dt, rear_v = np.empty(n - middle), np.empty(n - middle + 1)
    rear_s = (s[n] - s[middle:])[::-1].copy()
    rear_v[0] = v[n]
    share, miss, other, known = 0.0, 0.0, 0.0, False
    for step in range(_STEPS):
        a[:] = first + share * bump
        rear_a = -a[middle:][::-1].copy()
        if not (
            _half(s[: middle + 1], a[: middle + 1], dt[:middle], v[: middle + 1])
            and _half(rear_s, rear_a, rear_dt, rear_v)
        ):
            return False
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
            return False
    for i in range(middle, n):
        dt[i] = rear_dt[n - 1 - i]
        v[i + 1] = rear_v[n - 1 - i]
    return True


@kernel
def through_nodes(
    time: Array, s: Array, v: Array, a: Array, slow: Indices
) -> tuple[Array, Array, Array, Array]:
    """Return the motion from rest to rest through nodes.

    It is built part by part, from slow nodes, where its speed is as given, towards the fastest
    one between, where an error of the speed counts least: built in one go, a long motion would
    carry an error made where it is fast to where it is slow, and end there.

    Args:
        time: Nearly the times of the nodes [s], shape (n + 1,), rising.
        s: Path positions there, shape (n + 1,), strictly increasing.
        v: Path velocities there, nearly, shape (n + 1,).
        a: Path accelerations there, shape (n + 1,); those at the ends are taken to be zero. In
            each part they are changed by a parabola over time that is zero at both of its ends.
        slow: The ends of the parts, shape (k + 1,), at least one node between any two.

    Returns:
        Times, path positions, velocities and accelerations; times of NaN: there is none.
    """
    n = len(s) - 1
    dt, speed, here = np.empty(n), np.zeros(n + 1), a.copy()
    here[0], here[n] = 0.0, 0.0
    for k in range(len(slow) - 1):
        i, j = slow[k], slow[k + 1]
        x = (time[i : j + 1] - time[i]) / (time[j] - time[i])
        middle = min(max(int(np.argmax(v[i : j + 1])), 1), j - i - 1)
        speed[j] = v[j] if j < n else 0.0
        if not _part(
            s[i : j + 1], here[i : j + 1], x * (1.0 - x), middle, dt[i:j], speed[i : j + 1]
        ):
            return np.full(n + 1, np.nan), s, v, here
    at = np.zeros(n + 1)
    for i in range(n):
        at[i + 1] = at[i] + dt[i]
    return at, s, speed, here
