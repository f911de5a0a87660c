"""The largest limit ratio of each span from rest to rest, and how fast intervals are passed."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.timing.limit_ratios import acceleration_ratio, ratio_of, velocity_ratio

__all__ = ["largest_ratios", "run_durations", "speed_ratios"]

# A ratio is computed only where it may be the largest: what is compared instead of dividing may
# be off by rounding.
_ROUNDING_LESS = 1.0 - 1e-12
_ROUNDING_MORE = 1.0 + 1e-12


@kernel
def largest_ratios(
    h: Array,
    x: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    velocity: Array,
    velocity_lower: Array,
    acceleration: Array,
    acceleration_lower: Array,
    ends: Indices,
    least: float,
    wanted: Flags,
) -> Array:
    """Return the greatest limit ratio of each run of intervals, as a ratio of x.

    What limit_ratios finds, but only where it may be more than what is known already.

    Args:
        h: Lengths of the intervals, shape (n,).
        x: Squared path velocities at the nodes, shape (n + 1,).
        qs0: dq/ds at the starts, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        pieces: Piece of each interval, shape (n,).
        velocity: Upper velocity limits of the pieces, shape (k, dof).
        velocity_lower: Lower velocity limits of the pieces, shape (k, dof), negative.
        acceleration: Upper acceleration limits of the pieces, shape (k, dof).
        acceleration_lower: Lower acceleration limits of the pieces, shape (k, dof), negative.
        ends: First interval of each run, and n, shape (r + 1,).
        least: Smaller ratios count as this.
        wanted: Which runs are looked at, shape (r,); of the others the least is returned.

    Returns:
        The ratios, shape (r,).
    """
    dof = qs0.shape[1]
    largest = np.empty(len(ends) - 1)
    for run in range(len(largest)):
        best = least
        if not wanted[run]:
            largest[run] = best
            continue
        for i in range(ends[run], ends[run + 1]):
            k, d, x0, x1 = pieces[i], h[i], x[i], x[i + 1]
            u = (x1 - x0) / (2.0 * d)
            top = max(x0, x1) * _ROUNDING_MORE
            less = best * _ROUNDING_LESS
            for j in range(dof):
                qs, c, e = qs0[i, j], qss0[i, j], qss1[i, j]
                up, down = velocity[k, j], velocity_lower[k, j]
                # Bezier coefficients bound the quadratics.
                slope = max(abs(qs), abs(qs + 0.5 * d * c), abs(qs + 0.5 * d * (c + e)))
                if slope * slope * top > less * min(up * up, down * down):
                    ratio = velocity_ratio(d, x0, u, qs, c, e, up, down)
                    best = max(best, ratio * ratio)
                    less = best * _ROUNDING_LESS
                up, down = acceleration[k, j], acceleration_lower[k, j]
                C = 0.5 * (e - c) / d
                c0, c1 = qs * u + c * x0, 3.0 * c * u + 2.0 * C * x0
                inner, last = c0 + 0.5 * d * c1, c0 + d * (c1 + d * (5.0 * C * u))
                if max(c0, inner, last) > less * up or min(c0, inner, last) < less * down:
                    best = max(best, acceleration_ratio(d, x0, u, qs, c, e, up, down))
                    less = best * _ROUNDING_LESS
        largest[run] = best
    return largest


@kernel
def speed_ratios(
    h: Array,
    x: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    velocity: Array,
    velocity_lower: Array,
    acceleration: Array,
    acceleration_lower: Array,
) -> Array:
    """Return how fast every interval is passed, as a ratio to what its limits seem to allow.

    In a time-optimal motion some limit binds at every time. The mean over an interval of the
    greatest ratio (of velocity, or root of the ratio of acceleration: both grow in proportion to
    speed) therefore shows what the grid costs there.

    Args:
        h: As in largest_ratios.
        x: As in largest_ratios.
        qs0: As in largest_ratios.
        qss0: As in largest_ratios.
        qss1: As in largest_ratios.
        pieces: As in largest_ratios.
        velocity: As in largest_ratios.
        velocity_lower: As in largest_ratios.
        acceleration: As in largest_ratios.
        acceleration_lower: As in largest_ratios.

    Returns:
        Ratios, about 0 to 1, shape (n,).
    """
    n, dof = qs0.shape
    mean = np.zeros(n)
    x_here, root, v_best, a_best = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(n):
        k = pieces[i]
        u = (x[i + 1] - x[i]) / (2.0 * h[i])
        for part in range(3):
            x_here[part] = max(x[i] + 2.0 * u * (0.5 * part * h[i]), 0.0)
            root[part] = np.sqrt(x_here[part])
            v_best[part] = a_best[part] = 0.0
        for j in range(dof):
            C = 0.5 * (qss1[i, j] - qss0[i, j]) / h[i]
            up, down = velocity[k, j], velocity_lower[k, j]
            a_up, a_down = acceleration[k, j], acceleration_lower[k, j]
            for part in range(3):
                r = 0.5 * part * h[i]
                qs = qs0[i, j] + r * (qss0[i, j] + r * C)
                qss = qss0[i, j] + 2.0 * C * r
                v, a = qs * root[part], qs * u + qss * x_here[part]
                less = v_best[part] * _ROUNDING_LESS
                if v > less * up or v < less * down:
                    v_best[part] = max(v_best[part], ratio_of(v, up, down))
                less = a_best[part] * _ROUNDING_LESS
                if a > less * a_up or a < less * a_down:
                    a_best[part] = max(a_best[part], ratio_of(a, a_up, a_down))
        for part in range(3):
            ratio = max(v_best[part], np.sqrt(a_best[part]))
            mean[i] += ratio * (4.0 if part == 1 else 1.0) / 6.0
    return mean


@kernel
def run_durations(h: Array, x: Array, ends: Indices, factor: Array) -> Array:
    """Return the duration of each run of intervals [s], shape (r,).

    Args:
        h: As in largest_ratios.
        x: As in largest_ratios.
        ends: As in largest_ratios.
        factor: By what x is divided in each run, shape (r,).
    """
    durations = np.empty(len(factor))
    for run in range(len(factor)):
        total, here = 0.0, np.sqrt(x[ends[run]])
        for i in range(ends[run], ends[run + 1]):
            after = np.sqrt(x[i + 1])
            total += 2.0 * h[i] / (here + after)
            here = after
        durations[run] = total * np.sqrt(factor[run])
    return durations
