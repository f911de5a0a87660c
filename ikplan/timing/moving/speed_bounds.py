"""The lowest path speeds of a motion that begins or ends moving."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["lowest_speeds"]


@kernel
def lowest_speeds(s: Array, a: Array, b: Array, x_first: float, x_last: float) -> Array:
    """Return the squared path velocities below which a motion cannot be, shape (n + 1,).

    From the start it is the one of hardest braking, towards the end that of the hardest setting
    out: where neither holds, zero.

    Args:
        s: Path positions of the nodes, shape (n + 1,).
        a: Coefficients of u in rows a u + b x <= 1, shape (n, m).
        b: Coefficients of x, shape (n, m).
        x_first: Squared path velocity at the start.
        x_last: That at the end.
    """
    n, m = a.shape
    low = np.zeros(n + 1)
    low[0] = x_first
    for i in range(n):
        if low[i] <= 0.0:
            break
        u = -np.inf
        for r in range(m):
            if a[i, r] < 0.0:
                u = max(u, (1.0 - b[i, r] * low[i]) / a[i, r])
        low[i + 1] = max(low[i] + 2.0 * (s[i + 1] - s[i]) * u, 0.0)
    x = x_last
    low[n] = max(low[n], x)
    for i in range(n - 1, -1, -1):
        h = 2.0 * (s[i + 1] - s[i])
        before = 0.0
        for r in range(m):
            if a[i, r] > 0.0:
                # x_before + h (1 - b x_before) / a reaches x.
                slope = 1.0 - h * b[i, r] / a[i, r]
                if slope > 0.0:
                    before = max(before, (x - h / a[i, r]) / slope)
        if before <= 0.0:
            break
        x = before
        low[i] = max(low[i], x)
    return low
