"""How far a motion with constant path jerk between nodes uses its limits, place by place."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.joint_path.evaluation import _piece, interval_near, interval_of
from ikplan.timing.jerk.cubic_kernels import path_position

__all__ = ["path_rates", "slowdown_factors", "spread"]


# How far inside an interval its ends are looked at, as a share of its duration.
_INSIDE = 1e-7


@kernel
def slowdown_factors(
    s_knots: Array,
    q: Array,
    m0: Array,
    m1: Array,
    third: Array,
    time: Array,
    s: Array,
    v: Array,
    a: Array,
    velocity: Array,
    velocity_lower: Array,
    acceleration: Array,
    acceleration_lower: Array,
    jerk: Array,
    points: int,
    places: Array,
) -> Array:
    """Return by how much a motion would have to be slowed to keep its limits, place by place.

    The jerk of a joint is q' j + 3 q'' v a + q''' v^3. Limits are measured at equally spaced
    points of every interval, both ends included.

    Args:
        s_knots: Knots of the path, shape (k + 1,).
        q: Joint positions at the knots, shape (k + 1, dof).
        m0: Tangents at the start of each piece, shape (k, dof).
        m1: Tangents at the end of each piece, shape (k, dof).
        third: d3q/ds3 of every piece, shape (k, dof).
        time: Times of the nodes [s], shape (n + 1,).
        s: Path positions of the nodes, shape (n + 1,).
        v: Path velocities at the nodes, shape (n + 1,).
        a: Path accelerations at the nodes, shape (n + 1,).
        velocity: Upper velocity limits on every piece, shape (k, dof).
        velocity_lower: Lower velocity limits on every piece, shape (k, dof).
        acceleration: Upper acceleration limits on every piece, shape (k, dof).
        acceleration_lower: Lower acceleration limits on every piece, shape (k, dof).
        jerk: Jerk limits on every piece, shape (k, dof), may be inf.
        points: Number of steps between the points of an interval.
        places: Ends of the ranges of s that are kept apart, shape (p + 1,).

    Returns:
        Factors of time, 1 where a limit is just kept, shape (p,).
    """
    found = np.zeros(len(places) - 1)
    k, place = interval_of(s_knots, s[0]), interval_of(places, s[0])
    for i in range(len(time) - 1):
        dt = time[i + 1] - time[i]
        if dt <= 0.0:
            continue
        for point in range(points + 1):
            # The ends of an interval from inside: at a knot the limits and the curvature may step.
            t = time[i] + dt * min(max(point / points, _INSIDE), 1.0 - _INSIDE)
            at, speed, pull, j_path = path_position(time, s, v, a, i, t)
            k, place = interval_near(s_knots, at, k), interval_near(places, at, place)
            length = s_knots[k + 1] - s_knots[k]
            fraction = min(max((at - s_knots[k]) / length, 0.0), 1.0)
            top_v, top_a, top_j = 0.0, 0.0, 0.0
            for j in range(q.shape[1]):
                _, qs, qss = _piece(length, fraction, q[k, j], q[k + 1, j], m0[k, j], m1[k, j])
                dq = qs * speed
                ddq = qs * pull + qss * speed * speed
                dddq = qs * j_path + 3.0 * qss * speed * pull + third[k, j] * speed**3
                # The limit on the side to which it goes is the one that it may exceed.
                top_v = max(top_v, dq / (velocity[k, j] if dq > 0.0 else velocity_lower[k, j]))
                limit = acceleration[k, j] if ddq > 0.0 else acceleration_lower[k, j]
                top_a = max(top_a, ddq / limit)
                top_j = max(top_j, abs(dddq) / jerk[k, j])
            found[place] = max(found[place], top_v, np.sqrt(top_a), np.cbrt(top_j))
    return found


@kernel
def path_rates(time: Array, s: Array, v: Array, a: Array, places: Array) -> tuple[Array, Array]:
    """Return path velocities and accelerations at path positions, to nine digits or so.

    Args:
        time: Times of the nodes [s], shape (n + 1,).
        s: Path positions of the nodes, shape (n + 1,).
        v: Path velocities at the nodes, shape (n + 1,).
        a: Path accelerations at the nodes, shape (n + 1,).
        places: Path positions, shape (m,).

    Returns:
        Shapes (m,).
    """
    speeds, pulls = np.empty(len(places)), np.empty(len(places))
    for row in range(len(places)):
        i = min(max(np.searchsorted(s, places[row]) - 1, 0), len(time) - 2)
        dt, way = time[i + 1] - time[i], s[i + 1] - s[i]
        j = (a[i + 1] - a[i]) / dt if dt > 0.0 else 0.0
        r = min(max(places[row] - s[i], 0.0), way)
        # As if the acceleration were constant; where the motion begins at rest, as if the jerk.
        root = v[i] * v[i] + 2.0 * a[i] * r
        t = 2.0 * r / (v[i] + np.sqrt(root)) if root > 0.0 else dt * np.cbrt(r / max(way, 1e-300))
        t = min(max(t, 0.0), dt) if r < way else dt
        low, high = 0.0, dt
        for _ in range(40):
            miss = t * (v[i] + t * (0.5 * a[i] + t * j / 6.0)) - r
            if abs(miss) <= 1e-10 * way or not low < high:
                break
            if miss > 0.0:
                high = t
            else:
                low = t
            speed = v[i] + t * (a[i] + 0.5 * t * j)
            following = t - miss / speed if speed > 0.0 else low
            t = following if low < following < high else 0.5 * (low + high)
        speeds[row] = max(v[i] + t * (a[i] + 0.5 * t * j), 0.0)
        pulls[row] = a[i] + t * j
    return speeds, pulls


@kernel
def spread(values: Array, time: Array, reach: float) -> Array:
    """Return the greatest value within a reach in time of every interval.

    Args:
        values: One value an interval, shape (n,).
        time: Times of the ends of the intervals [s], shape (n + 1,).
        reach: How far to look, each way [s].

    Returns:
        Shape (n,).
    """
    n = len(values)
    out = np.empty(n)
    # Indices of the candidates for the maximum of the window, their values falling.
    queue = np.empty(n, np.int64)
    head, tail, entering = 0, 0, 0
    for i in range(n):
        while entering < n and (entering <= i or time[entering] < time[i + 1] + reach):
            while tail > head and values[queue[tail - 1]] <= values[entering]:
                tail -= 1
            queue[tail] = entering
            tail += 1
            entering += 1
        while time[queue[head] + 1] <= time[i] - reach:
            head += 1
        out[i] = values[queue[head]]
    return out
