"""How far a timing uses its limits: exact maxima in every interval, not samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel

__all__ = ["usage"]

Array = NDArray[np.float64]


@kernel
def _ratio(value: float, upper: float, lower: float) -> float:
    return value / upper if value >= 0.0 else value / lower


@kernel
def usage(
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
    """Return the greatest share of the velocity and acceleration limits in every interval.

    With q'(s) = A + B r + C r^2 on an interval and x = x0 + 2 u r, r from its start, a joint's
    acceleration q' u + q'' x = (A u + B x0) + (3 B u + 2 C x0) r + 5 C u r^2 is a quadratic: its
    extrema are at the ends or the vertex. Its velocity q' sqrt(x) is extreme at the ends or where
    the acceleration is zero.

    Args:
        h: Lengths of the intervals, shape (n,).
        x: Squared path velocities at the nodes, shape (n + 1,).
        qs0: dq/ds at the starts, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        velocity: Upper velocity limits, shape (dof,).
        velocity_lower: Lower velocity limits, shape (dof,), negative.
        acceleration: Upper acceleration limits, shape (dof,).
        acceleration_lower: Lower acceleration limits, shape (dof,), negative.

    Returns:
        Shares of the velocity and of the acceleration limits, each of shape (n, dof).
    """
    n, dof = qs0.shape
    v_share, a_share = np.empty((n, dof)), np.empty((n, dof))
    for i in range(n):
        length, x0 = h[i], x[i]
        u = (x[i + 1] - x0) / (2.0 * length)
        for j in range(dof):
            A, B = qs0[i, j], qss0[i, j]
            C = 0.5 * (qss1[i, j] - B) / length
            c0, c1, c2 = A * u + B * x0, 3.0 * B * u + 2.0 * C * x0, 5.0 * C * u
            top_a = _ratio(c0, acceleration[j], acceleration_lower[j])
            end = c0 + length * (c1 + length * c2)
            top_a = max(top_a, _ratio(end, acceleration[j], acceleration_lower[j]))
            if c2 != 0.0:
                vertex = -c1 / (2.0 * c2)
                if 0.0 < vertex < length:
                    value = c0 + vertex * (c1 + vertex * c2)
                    top_a = max(top_a, _ratio(value, acceleration[j], acceleration_lower[j]))
            a_share[i, j] = top_a
            top_v = 0.0
            discriminant = c1 * c1 - 4.0 * c2 * c0
            w = -0.5 * (c1 + (1.0 if c1 >= 0.0 else -1.0) * np.sqrt(max(discriminant, 0.0)))
            roots = (
                0.0,
                length,
                w / c2 if c2 != 0.0 else 0.0,
                c0 / w if w != 0.0 else 0.0,
            )
            for r in roots:
                if 0.0 <= r <= length:
                    speed = np.sqrt(max(x0 + 2.0 * u * r, 0.0))
                    value = (A + r * (B + r * C)) * speed
                    top_v = max(top_v, _ratio(value, velocity[j], velocity_lower[j]))
            v_share[i, j] = top_v
    return v_share, a_share
