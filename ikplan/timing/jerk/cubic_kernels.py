"""Motions along a path with constant path jerk between nodes: filtered and evaluated."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.joint_path.evaluation import _piece, interval_of

__all__ = ["evaluate_cubic", "moving_average", "path_position", "times_of"]


@kernel
def moving_average(time: Array, s: Array, sdot: Array, window: float) -> tuple[Array, ...]:
    """Smooth a path speed over time by a moving average.

    The path acceleration of the input is constant between nodes; that of the output is linear,
    continuous, and zero at both ends. The motion takes longer by the window.

    Args:
        time: Times of the nodes [s], shape (n + 1,), from 0.
        s: Path positions of the nodes, shape (n + 1,).
        sdot: Path velocities at the nodes, shape (n + 1,), zero at both ends.
        window: Length of the window [s], > 0.

    Returns:
        Times, path positions, velocities and accelerations of the new nodes, (m + 1,) each.
    """
    t = np.sort(np.concatenate((time, time + window)))
    # Nodes that nearly coincide would have a jerk between them that is made of rounding.
    closest = 1e-9 * t[-1]
    count = 1
    for k in range(1, len(t)):
        if t[k] - t[count - 1] > closest:
            t[count] = t[k]
            count += 1
    t[count - 1] = time[-1] + window
    t = t[:count].copy()
    v, a, out = np.empty(count), np.empty(count), np.empty(count)
    for k in range(count):
        ends = np.empty(2)
        speeds = np.empty(2)
        for side in range(2):
            at = min(max(t[k] - side * window, time[0]), time[-1])
            i = interval_of(time, at)
            u = (sdot[i + 1] - sdot[i]) / (time[i + 1] - time[i])
            r = at - time[i]
            ends[side] = s[i] + r * (sdot[i] + 0.5 * u * r)
            speeds[side] = sdot[i] + u * r
        v[k] = max(ends[0] - ends[1], 0.0) / window
        a[k] = (speeds[0] - speeds[1]) / window
    v[0], v[-1], a[0], a[-1] = 0.0, 0.0, 0.0, 0.0
    out[0] = s[0]
    for k in range(count - 1):
        dt = t[k + 1] - t[k]
        # The integral of a velocity that is quadratic in time, given at both ends with its slope.
        step = dt * (0.5 * (v[k] + v[k + 1]) + dt * (a[k] - a[k + 1]) / 12.0)
        out[k + 1] = min(max(out[k] + step, out[k]), s[-1])
    out[-1] = s[-1]
    return t, out, v, a


@kernel
def path_position(
    time: Array, s: Array, v: Array, a: Array, i: int, t: float
) -> tuple[float, float, float, float]:
    """Return path position, velocity, acceleration and jerk at a time in interval i."""
    dt = time[i + 1] - time[i]
    j = (a[i + 1] - a[i]) / dt if dt > 0.0 else 0.0
    before, after = t - time[i], time[i + 1] - t
    # From the nearer end, so that both nodes are met exactly.
    if before <= after:
        at = s[i] + before * (v[i] + before * (0.5 * a[i] + before * j / 6.0))
        speed = v[i] + before * (a[i] + 0.5 * before * j)
        pull = a[i] + before * j
    else:
        at = s[i + 1] - after * (v[i + 1] - after * (0.5 * a[i + 1] - after * j / 6.0))
        speed = v[i + 1] - after * (a[i + 1] - 0.5 * after * j)
        pull = a[i + 1] - after * j
    return min(max(at, s[i]), s[i + 1]), max(speed, 0.0), pull, j


@kernel
def times_of(time: Array, s: Array, v: Array, a: Array, places: Array) -> Array:
    """Return when path positions are reached, by bracketed Newton steps on the monotone s(t).

    Args:
        time: Times of the nodes [s], shape (n + 1,).
        s: Path positions of the nodes, shape (n + 1,).
        v: Path velocities at the nodes, shape (n + 1,).
        a: Path accelerations at the nodes, shape (n + 1,).
        places: Path positions, shape (m,).

    Returns:
        Times [s], shape (m,); the first of them where the motion stands still.
    """
    out = np.empty(len(places))
    for row in range(len(places)):
        # The first interval that ends at the place or beyond it.
        i = min(max(np.searchsorted(s, places[row]) - 1, 0), len(time) - 2)
        low, high = time[i], time[i + 1]
        if places[row] <= s[i]:
            high = low
        elif places[row] >= s[i + 1]:
            low = high
        t = 0.5 * (low + high)
        for _ in range(100):
            if not low < t < high:
                t = 0.5 * (low + high)
                if not low < t < high:
                    break
            at, speed, _, _ = path_position(time, s, v, a, i, t)
            if at < places[row]:
                low = t
            else:
                high = t
            # A hair farther than Newton's step, so that the bracket closes from both sides.
            step = (places[row] - at) / speed if speed > 0.0 else math.inf
            t += step + math.copysign(1e-3 * abs(step) + 4e-16 * t, step)
        out[row] = high
    return out


@kernel
def evaluate_cubic(
    s_knots: Array,
    q: Array,
    m0: Array,
    m1: Array,
    time: Array,
    s: Array,
    v: Array,
    a: Array,
    times: Array,
) -> tuple[Array, Array, Array, Array]:
    """Evaluate a joint path along a motion with constant path jerk between nodes.

    Args:
        s_knots: Knots of the path, shape (k + 1,).
        q: Joint positions at the knots, shape (k + 1, dof).
        m0: Tangents at the start of each piece, shape (k, dof).
        m1: Tangents at the end of each piece, shape (k, dof).
        time: Times of the nodes [s], shape (n + 1,).
        s: Path positions of the nodes, shape (n + 1,).
        v: Path velocities at the nodes, shape (n + 1,).
        a: Path accelerations at the nodes, shape (n + 1,).
        times: Times asked for [s], shape (m,); clipped to the ends.

    Returns:
        Joint positions, velocities and accelerations, (m, dof) each, and path positions, (m,).
    """
    n, dof = times.shape[0], q.shape[1]
    out0, out1, out2 = np.empty((n, dof)), np.empty((n, dof)), np.empty((n, dof))
    places = np.empty(n)
    for row in range(n):
        t = min(max(times[row], time[0]), time[-1])
        at, speed, pull, _ = path_position(time, s, v, a, interval_of(time, t), t)
        k = interval_of(s_knots, at)
        length = s_knots[k + 1] - s_knots[k]
        fraction = min(max((at - s_knots[k]) / length, 0.0), 1.0)
        places[row] = at
        for j in range(dof):
            position, qs, qss = _piece(length, fraction, q[k, j], q[k + 1, j], m0[k, j], m1[k, j])
            out0[row, j] = position
            out1[row, j] = qs * speed
            out2[row, j] = qs * pull + qss * speed * speed
    return out0, out1, out2, places
