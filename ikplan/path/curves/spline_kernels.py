"""The compiled linear system of the natural cubic spline."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["natural_slopes"]


@kernel
def natural_slopes(x: Array, y: Array) -> Array:
    """Return the first derivatives of the natural cubic spline at its knots.

    The equations say that the second derivative is continuous at inner knots and zero at both
    ends. They are tridiagonal, and solved by Gaussian elimination with partial pivoting, operation
    by operation as in LAPACK's dgtsv.

    Args:
        x: Increasing knots, shape (k,), k >= 2.
        y: Values at them, shape (k, columns).

    Returns:
        Shape (k, columns).
    """
    n, columns = y.shape
    lower, diagonal, upper = np.empty(n - 1), np.empty(n), np.empty(n - 1)
    second = np.zeros(n - 1)  # the second upper diagonal, which exchanges of rows fill
    b = np.empty((n, columns))
    h = x[1] - x[0]
    diagonal[0], upper[0] = 2.0 * h, h
    for j in range(columns):
        b[0, j] = 3.0 * (y[1, j] - y[0, j])
    for i in range(1, n - 1):
        after = x[i + 1] - x[i]
        lower[i - 1], diagonal[i], upper[i] = after, 2.0 * (h + after), h
        for j in range(columns):
            left, right = (y[i, j] - y[i - 1, j]) / h, (y[i + 1, j] - y[i, j]) / after
            b[i, j] = 3.0 * (after * left + h * right)
        h = after
    lower[n - 2], diagonal[n - 1] = h, 2.0 * h
    for j in range(columns):
        b[n - 1, j] = 3.0 * (y[n - 1, j] - y[n - 2, j])
    for i in range(n - 1):
        if abs(diagonal[i]) >= abs(lower[i]):
            factor = lower[i] / diagonal[i]
            diagonal[i + 1] -= factor * upper[i]
            for j in range(columns):
                b[i + 1, j] -= factor * b[i, j]
            continue
        factor = diagonal[i] / lower[i]
        diagonal[i], below = lower[i], diagonal[i + 1]
        diagonal[i + 1] = upper[i] - factor * below
        if i < n - 2:
            second[i] = upper[i + 1]
            upper[i + 1] = -factor * second[i]
        upper[i] = below
        for j in range(columns):
            above = b[i, j]
            b[i, j] = b[i + 1, j]
            b[i + 1, j] = above - factor * b[i + 1, j]
    for j in range(columns):
        b[n - 1, j] /= diagonal[n - 1]
        b[n - 2, j] = (b[n - 2, j] - upper[n - 2] * b[n - 1, j]) / diagonal[n - 2]
        for i in range(n - 3, -1, -1):
            known = b[i, j] - upper[i] * b[i + 1, j] - second[i] * b[i + 2, j]
            b[i, j] = known / diagonal[i]
    return b
