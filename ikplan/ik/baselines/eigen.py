"""Eigenvalues of a small symmetric matrix by Jacobi's rotations, with no library behind it."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["eigen_into"]

SWEEPS = 30
"""Most sweeps over all pairs; ten are plenty for a hundred dimensions."""


@kernel
def eigen_into(C: Array, values: Array, vectors: Array) -> None:
    """Write eigenvalues and eigenvectors of a symmetric matrix.

    Source: Golub, Van Loan, Matrix Computations, section 8.5, cyclic Jacobi.

    Args:
        C: Matrix, shape (n, n).
        values: Out: eigenvalues, in no order, shape (n,).
        vectors: Out: the eigenvectors as columns, shape (n, n).
    """
    n = C.shape[0]
    A = C.copy()
    vectors[:] = np.eye(n)
    for _ in range(SWEEPS):
        off, diagonal = 0.0, 0.0
        for p in range(n):
            diagonal += A[p, p] * A[p, p]
            for q in range(p + 1, n):
                off += A[p, q] * A[p, q]
        if off <= 1e-32 * diagonal:
            break
        for p in range(n):
            for q in range(p + 1, n):
                if A[p, q] == 0.0:
                    continue
                tau = (A[q, q] - A[p, p]) / (2.0 * A[p, q])
                t = (1.0 if tau >= 0.0 else -1.0) / (abs(tau) + math.sqrt(1.0 + tau * tau))
                c = 1.0 / math.sqrt(1.0 + t * t)
                s = t * c
                for k in range(n):
                    x, y = A[k, p], A[k, q]
                    A[k, p], A[k, q] = c * x - s * y, s * x + c * y
                for k in range(n):
                    x, y = A[p, k], A[q, k]
                    A[p, k], A[q, k] = c * x - s * y, s * x + c * y
                    x, y = vectors[k, p], vectors[k, q]
                    vectors[k, p], vectors[k, q] = c * x - s * y, s * x + c * y
    for k in range(n):
        values[k] = A[k, k]
