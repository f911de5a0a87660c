"""Compiled least squares of cubic B-splines with a penalty; see :mod:`ikplan.smoothing.box_fit`."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices

__all__ = ["BANDS", "minimax_fit"]

BANDS = 4
"""Cubic B-splines that are not zero at a point; bands of their products, the diagonal's counted."""
_FAR = 3.0
"""Where a point is this many times as far off as it may be, more weight on it does not help."""
_LEAST_WEIGHT = 0.2


@kernel
def _solved(bands: Array, right: Array) -> None:
    """Solve a symmetric positive definite banded system in place by Cholesky's method.

    Args:
        bands: Lower bands, ``bands[i, k] = A[i + k, i]``, shape (m, BANDS); replaced.
        right: Right sides, shape (m, d); replaced by the solutions.
    """
    m, d = right.shape
    for i in range(m):
        most = min(BANDS, m - i)
        root = math.sqrt(bands[i, 0])
        for k in range(most):
            bands[i, k] /= root
        for k in range(1, most):
            for o in range(k, most):
                bands[i + k, o - k] -= bands[i, k] * bands[i, o]
        for j in range(d):
            right[i, j] /= root
            for k in range(1, most):
                right[i + k, j] -= bands[i, k] * right[i, j]
    for i in range(m - 1, -1, -1):
        for j in range(d):
            total = right[i, j]
            for k in range(1, min(BANDS, m - i)):
                total -= bands[i, k] * right[i + k, j]
            right[i, j] = total / bands[i, 0]


@kernel
def _fit(
    first: Indices, values: Array, bend: Array, y: Array, weights: Array, bending: float
) -> Array:
    """Coefficients of the best curve that begins at the first and ends at the last point."""
    n, d = y.shape
    m = len(bend)
    bands = bending * bend
    right = np.zeros((m, d))
    for i in range(n):
        for a in range(BANDS):
            share = weights[i] * values[i, a]
            row = first[i] + a
            for b in range(a, BANDS):
                bands[row, b - a] += share * values[i, b]
            for j in range(d):
                right[row, j] += share * y[i, j]
    # The first and the last coefficient are the ends: what they add goes to the right side.
    for k in range(1, BANDS):
        for j in range(d):
            right[k, j] -= bands[0, k] * y[0, j]
            right[m - 1 - k, j] -= bands[m - 1 - k, k] * y[n - 1, j]
    inner = np.zeros((m - 2, BANDS))
    for i in range(m - 2):
        for k in range(min(BANDS, m - 2 - i)):
            inner[i, k] = bands[i + 1, k]
    coefficients = right.copy()
    _solved(inner, coefficients[1 : m - 1])
    for j in range(d):
        coefficients[0, j] = y[0, j]
        coefficients[m - 1, j] = y[n - 1, j]
    return coefficients


@kernel
def minimax_fit(
    first: Indices,
    values: Array,
    bend: Array,
    y: Array,
    half_width: Array,
    group: Indices,
    bending: float,
    rounds: int,
) -> tuple[Array, Array]:
    """Fit, with more weight on the points farthest off; the best of some rounds.

    Args:
        first: Index of the first coefficient that counts at each point, shape (n,).
        values: What it and the next ones count there, shape (n, BANDS).
        bend: Lower bands of the integral of the squared second derivative,
            ``bend[i, k] = B[i + k, i]``, shape (m, BANDS).
        y: Points, shape (n, d).
        half_width: How far the curve may be off along each axis, shape (n, d).
        group: Number of the group of each axis, shape (d,): those of a group are off together, by
            the root of the sum of the squares of their ratios.
        bending: Weight of the bending.
        rounds: Most rounds.

    Returns:
        Coefficients, shape (m, d), and how far the curve is off each point, as a ratio of what it
        may be, shape (n,).
    """
    n, d = y.shape
    weights = np.ones(n)
    best = np.zeros((len(bend), d))
    least = np.full(n, np.inf)
    off = np.empty(n)
    square = np.empty(group.max() + 1)
    for _ in range(rounds):
        coefficients = _fit(first, values, bend, y, weights, bending)
        for i in range(n):
            square[:] = 0.0
            for j in range(d):
                here = -y[i, j]
                for a in range(BANDS):
                    here += values[i, a] * coefficients[first[i] + a, j]
                square[group[j]] += (here / half_width[i, j]) ** 2
            off[i] = math.sqrt(square.max())
        worst = off.max()
        if worst < least.max():
            best = coefficients
            least = off.copy()
        if worst <= 1.0 or worst > _FAR:
            break
        weights = weights * (_LEAST_WEIGHT + off / worst)
        weights /= weights.mean()
    return best, least
