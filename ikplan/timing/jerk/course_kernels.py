"""A motion to be played at another speed: its rates, and the splines of that speed."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.joint_path.evaluation import _piece, interval_of
from ikplan.timing.jerk.cubic_kernels import path_position

__all__ = ["FIRST", "apart", "course_rates", "spline_basis"]

# Where in an interval limits are looked at: the nodes of Gauss, at which means are exact.
FIRST = 0.5 - 0.5 / np.sqrt(3.0)


@kernel
def spline_basis(tau: Array, shares: Array) -> tuple[Array, Array, Array]:
    """Return the quadratic B-splines over knots, with their derivatives.

    Args:
        tau: Knots, shape (n + 1,), strictly increasing; those at the ends count thrice.
        shares: Where in each interval, from 0 to 1, shape (p,).

    Returns:
        Values and first derivatives of the three splines that are not zero in an interval, shape
        (n, p, 3) each, and their second derivatives, shape (n, 3); in interval i, those of
        coefficients i to i + 2.
    """
    n = len(tau) - 1
    value, slope = np.empty((n, len(shares), 3)), np.empty((n, len(shares), 3))
    bend = np.empty((n, 3))
    for i in range(n):
        h = tau[i + 1] - tau[i]
        wide0 = tau[i + 1] - tau[max(i - 1, 0)]
        wide2 = tau[min(i + 2, n)] - tau[i]
        bend[i, 0], bend[i, 2] = 2.0 / (h * wide0), 2.0 / (h * wide2)
        bend[i, 1] = -bend[i, 0] - bend[i, 2]
        for k in range(len(shares)):
            after, before = h * (1.0 - shares[k]), h * shares[k]
            value[i, k, 0] = after * after / (h * wide0)
            value[i, k, 2] = before * before / (h * wide2)
            value[i, k, 1] = 1.0 - value[i, k, 0] - value[i, k, 2]
            slope[i, k, 0] = -2.0 * after / (h * wide0)
            slope[i, k, 2] = 2.0 * before / (h * wide2)
            slope[i, k, 1] = -slope[i, k, 0] - slope[i, k, 2]
    return value, slope, bend


@kernel
def course_rates(
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
) -> tuple[Array, Array, Array, Array, Array]:
    """Evaluate a motion and its limits as WarpLimits has them, tau the share of the duration.

    Args:
        s_knots: As in slowdown_factors, and so are the next four.
        q: Joint positions at the knots.
        m0: Tangents at the start of each piece.
        m1: Tangents at the end of each piece.
        third: d3q/ds3 of every piece.
        time: Times of the nodes [s], shape (n + 1,).
        s: Path positions of the nodes, shape (n + 1,).
        v: Path velocities at the nodes, shape (n + 1,).
        a: Path accelerations at the nodes, shape (n + 1,).
        velocity: As in slowdown_factors, and so are the next four.
        velocity_lower: Lower velocity limits.
        acceleration: Upper acceleration limits.
        acceleration_lower: Lower acceleration limits.
        jerk: Jerk limits.

    Returns:
        Rates, the upper bounds of b, the inverse acceleration limits, all as in WarpLimits, and
        path positions, velocities and accelerations, shape (n, 2, 3).
    """
    n, dof = len(time) - 1, q.shape[1]
    rates, most = np.empty((2, dof, 5, n)), np.full((2, n), np.inf)
    up, down, points = np.empty((2, dof, n)), np.empty((2, dof, n)), np.empty((n, 2, 3))
    end = time[n]
    for i in range(n):
        dt = time[i + 1] - time[i]
        for side in range(2):
            t = time[i] + dt * (FIRST if side == 0 else 1.0 - FIRST)
            at, speed, pull, j_path = path_position(time, s, v, a, i, t)
            k = interval_of(s_knots, at)
            length = s_knots[k + 1] - s_knots[k]
            fraction = min(max((at - s_knots[k]) / length, 0.0), 1.0)
            points[i, side, 0], points[i, side, 1], points[i, side, 2] = at, speed, pull
            for j in range(dof):
                _, qs, qss = _piece(length, fraction, q[k, j], q[k + 1, j], m0[k, j], m1[k, j])
                r1 = end * qs * speed
                r2 = end**2 * (qs * pull + qss * speed * speed)
                r3 = end**3 * (qs * j_path + 3.0 * qss * speed * pull + third[k, j] * speed**3)
                rates[side, j, 0, i], rates[side, j, 1, i] = r2, 0.5 * r1
                limit = jerk[k, j] * end**3
                rates[side, j, 2, i] = r3 / limit
                rates[side, j, 3, i] = 1.5 * r2 / limit
                rates[side, j, 4, i] = 0.5 * r1 / limit
                up[side, j, i] = 1.0 / (acceleration[k, j] * end**2)
                down[side, j, i] = 1.0 / (acceleration_lower[k, j] * end**2)
                if r1 != 0.0:
                    bound = (velocity[k, j] if r1 > 0.0 else velocity_lower[k, j]) * end / r1
                    most[side, i] = min(most[side, i], bound * bound)
    return rates, most, up, down, points


@kernel
def apart(times: Array, shortest: float) -> Array:
    """Return times without those that are too near to the one before, or to the last one.

    Args:
        times: Times [s], shape (n,), rising; the first and the last one stay.
        shortest: How near is too near [s].

    Returns:
        Shape (m,).
    """
    kept = times.copy()
    count = 1
    for t in times[1:-1]:
        if min(t - kept[count - 1], times[-1] - t) > shortest:
            kept[count] = t
            count += 1
    kept[count] = times[-1]
    return kept[: count + 1].copy()
