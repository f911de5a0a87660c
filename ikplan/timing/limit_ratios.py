"""Limit ratios of a timing: exact maxima in every interval, not samples."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["acceleration_ratio", "limit_ratios", "ratio_of", "velocity_ratio"]


@kernel
def ratio_of(value: float, upper: float, lower: float) -> float:
    """Return a value's ratio to the limit on its side, >= 0."""
    return value / upper if value >= 0.0 else value / lower


@kernel
def velocity_ratio(
    h: float, x0: float, u: float, qs: float, qss0: float, qss1: float, upper: float, lower: float
) -> float:
    """Return the greatest ratio to a joint's velocity limits on one interval.

    With q'(s) = A + B r + C r^2, r from the start, and x = x0 + 2 u r, the velocity q' sqrt(x) is
    extreme at the ends or where the acceleration is zero, a quadratic in r.

    Args:
        h: Length of the interval.
        x0: Squared path velocity at its start.
        u: Path acceleration.
        qs: dq/ds at the start.
        qss0: d2q/ds2 at the start.
        qss1: d2q/ds2 at the end.
        upper: Upper velocity limit.
        lower: Lower velocity limit, negative.

    Returns:
        The ratio, >= 0.
    """
    C = 0.5 * (qss1 - qss0) / h
    c0, c1, c2 = qs * u + qss0 * x0, 3.0 * qss0 * u + 2.0 * C * x0, 5.0 * C * u
    w = -0.5 * (c1 + (1.0 if c1 >= 0.0 else -1.0) * np.sqrt(max(c1 * c1 - 4.0 * c2 * c0, 0.0)))
    ratio = 0.0
    for r in (0.0, h, w / c2 if c2 != 0.0 else 0.0, c0 / w if w != 0.0 else 0.0):
        if 0.0 <= r <= h:
            speed = np.sqrt(max(x0 + 2.0 * u * r, 0.0))
            ratio = max(ratio, ratio_of((qs + r * (qss0 + r * C)) * speed, upper, lower))
    return ratio


@kernel
def acceleration_ratio(
    h: float, x0: float, u: float, qs: float, qss0: float, qss1: float, upper: float, lower: float
) -> float:
    """Return the greatest ratio to a joint's acceleration limits on one interval.

    The acceleration q' u + q'' x = (A u + B x0) + (3 B u + 2 C x0) r + 5 C u r^2 is a quadratic,
    extreme at the ends or at its vertex.

    Args:
        h: As in velocity_ratio.
        x0: As in velocity_ratio.
        u: As in velocity_ratio.
        qs: As in velocity_ratio.
        qss0: As in velocity_ratio.
        qss1: As in velocity_ratio.
        upper: Upper acceleration limit.
        lower: Lower acceleration limit, negative.

    Returns:
        The ratio, >= 0.
    """
    C = 0.5 * (qss1 - qss0) / h
    c0, c1, c2 = qs * u + qss0 * x0, 3.0 * qss0 * u + 2.0 * C * x0, 5.0 * C * u
    ratio = max(ratio_of(c0, upper, lower), ratio_of(c0 + h * (c1 + h * c2), upper, lower))
    vertex = -c1 / (2.0 * c2) if c2 != 0.0 else 0.0
    if 0.0 < vertex < h:
        ratio = max(ratio, ratio_of(c0 + vertex * (c1 + vertex * c2), upper, lower))
    return ratio


@kernel
def limit_ratios(
    h: Array,
    x: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    velocity: Array,
    velocity_lower: Array,
    acceleration: Array,
    acceleration_lower: Array,
) -> tuple[Array, Array]:
    """Return the greatest ratio to each joint's limits on every interval.

    Args:
        h: Lengths of the intervals, shape (n,).
        x: Squared path velocities at the nodes, shape (n + 1,).
        qs0: dq/ds at the starts, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        velocity: Upper velocity limits, shape (n, dof).
        velocity_lower: Lower velocity limits, shape (n, dof), negative.
        acceleration: Upper acceleration limits, shape (n, dof).
        acceleration_lower: Lower acceleration limits, shape (n, dof), negative.

    Returns:
        Ratios to the velocity and to the acceleration limits, each of shape (n, dof).
    """
    n, dof = qs0.shape
    v_ratio, a_ratio = np.empty((n, dof)), np.empty((n, dof))
    for i in range(n):
        u = (x[i + 1] - x[i]) / (2.0 * h[i])
        for j in range(dof):
            v_ratio[i, j] = velocity_ratio(
                h[i],
                x[i],
                u,
                qs0[i, j],
                qss0[i, j],
                qss1[i, j],
                velocity[i, j],
                velocity_lower[i, j],
            )
            a_ratio[i, j] = acceleration_ratio(
                h[i],
                x[i],
                u,
                qs0[i, j],
                qss0[i, j],
                qss1[i, j],
                acceleration[i, j],
                acceleration_lower[i, j],
            )
    return v_ratio, a_ratio
