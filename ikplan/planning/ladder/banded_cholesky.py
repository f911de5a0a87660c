"""Linear equations whose matrix has a narrow band: time linear in their number."""

from __future__ import annotations

import math

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["solve_banded"]


@kernel
def solve_banded(A: Array, b: Array, size: int, width: int) -> bool:
    """Solve A x = b in place for a symmetric positive definite band matrix, by Cholesky.

    Args:
        A: Lower band, A[i, width - (i - j)] is entry (i, j), shape (size, width + 1).
        b: In: right-hand side, out: x, shape (size,).
        size: Number of unknowns.
        width: Number of subdiagonals.

    Returns:
        Whether the matrix is positive definite.
    """
    for i in range(size):
        for j in range(max(0, i - width), i + 1):
            total = A[i, width - (i - j)]
            for m in range(max(0, i - width, j - width), j):
                total -= A[i, width - (i - m)] * A[j, width - (j - m)]
            if i == j:
                if total <= 0.0:
                    return False
                A[i, width] = math.sqrt(total)
            else:
                A[i, width - (i - j)] = total / A[j, width]
    for i in range(size):
        for m in range(max(0, i - width), i):
            b[i] -= A[i, width - (i - m)] * b[m]
        b[i] /= A[i, width]
    for back in range(size):
        i = size - 1 - back
        for m in range(i + 1, min(size, i + width + 1)):
            b[i] -= A[m, width - (m - i)] * b[m]
        b[i] /= A[i, width]
    return True
