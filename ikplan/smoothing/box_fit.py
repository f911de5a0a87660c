"""The cubic spline of least bending found that stays within a box about each point.

A penalised spline (Eilers and Marx, Flexible smoothing with B-splines and penalties, Statistical
Science 11, 1996, with the integral of the squared second derivative as the penalty): least squares
on few knots, which are added where the curve leaves a box; then the weight of the bending is
raised as far as the boxes allow.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array, Flags

if TYPE_CHECKING:
    from scipy.interpolate import BSpline
    from scipy.sparse import csr_array

__all__ = ["fit_within"]


_DEGREE = 3
_FIRST_SPANS = 4
_ROUNDS = 40
_LEAST_BENDING = 1e-9
"""Weight of the bending, as a share of that of the points, that only keeps the system regular."""
_DECADES = 14.0
_BISECTIONS = 22
_MINIMAX = 12
"""Rounds in which points near the edge of their box get more weight (C. L. Lawson, 1961)."""


@dataclass(frozen=True, eq=False)
class _Basis:
    """B-splines on knots, their values at the points and their bending."""

    knots: Array
    values: csr_array
    bending: csr_array

    @classmethod
    def on(cls, breaks: Array, u: Array) -> _Basis:
        from scipy.interpolate import BSpline  # slow to import
        from scipy.sparse import csr_array, diags_array

        k = _DEGREE
        t = np.concatenate([np.repeat(breaks[0], k), breaks, np.repeat(breaks[-1], k)])
        m = len(t) - k - 1
        values = csr_array(BSpline.design_matrix(u, t, k))
        # From coefficients to those of the second derivative, a spline of degree 1.
        first = k / (t[k + 1 : k + m] - t[1:m])
        second = (k - 1) / (t[k + 1 : k + m - 1] - t[2:m])
        d1 = diags_array([-first, first], offsets=[0, 1], shape=(m - 1, m))
        d2 = diags_array([-second, second], offsets=[0, 1], shape=(m - 2, m - 1))
        h = np.diff(breaks)
        main = (np.append(h, 0.0) + np.append(0.0, h)) / 3.0
        gram = diags_array([h / 6.0, main, h / 6.0], offsets=[-1, 0, 1])
        bend = csr_array(d2 @ d1)
        return cls(t, values, csr_array(bend.T @ gram @ bend))

    def fit(self, y: Array, weights: Array, bending: float) -> Array:
        """Coefficients of the best curve that begins at the first and ends at the last point.

        Args:
            y: Points, shape (n, d).
            weights: Their weights, shape (n,).
            bending: Weight of the integral of the squared second derivative.
        """
        from scipy.linalg import solveh_banded
        from scipy.sparse import csr_array, diags_array

        weighted = diags_array(weights) @ self.values
        matrix = csr_array(self.values.T @ weighted + bending * self.bending)
        right = weighted.T @ y
        ends = matrix[:, [0, -1]] @ y[[0, -1]]
        inner = (right - ends)[1:-1]
        m = matrix.shape[0] - 2
        bands = np.zeros((_DEGREE + 1, m))
        for k in range(_DEGREE + 1):
            bands[k, : m - k] = matrix.diagonal(-k)[1 : 1 + m - k]
        solved = solveh_banded(bands, inner, lower=True, check_finite=False)
        return np.vstack([y[:1], solved, y[-1:]])


def fit_within(u: Array, y: Array, half_width: Array) -> BSpline:
    """Return a cubic spline that passes each point within its box and bends little.

    It begins at the first point and ends at the last one exactly.

    Args:
        u: Parameters of the points, shape (n,), n >= 2, increasing strictly.
        y: Points, shape (n, d).
        half_width: Half widths of the boxes about them, shape (n, d), positive.
    """
    from scipy.interpolate import BSpline

    breaks = np.linspace(u[0], u[-1], _FIRST_SPANS + 1)
    basis = _Basis.on(breaks, u)
    least = _LEAST_BENDING
    for _ in range(_ROUNDS):
        weights = np.ones(len(u))
        coefficients, off = _minimax(basis, y, half_width, weights, _bending(basis, least))
        if off.max() <= 1.0:
            break
        divided = _divided(breaks, u, off > 1.0)
        if divided is None:
            # Every span is as short as the points allow: pass through them.
            breaks, least = u, 1e-3 * least
            basis = _Basis.on(breaks, u)
            coefficients = basis.fit(y, weights, _bending(basis, least))
            break
        breaks = divided
        basis = _Basis.on(breaks, u)
    best = coefficients
    low, high = 0.0, _DECADES
    for _ in range(_BISECTIONS):
        at = 0.5 * (low + high)
        coefficients, off = _minimax(
            basis, y, half_width, np.ones(len(u)), _bending(basis, least) * 10.0**at
        )
        if off.max() <= 1.0:
            best, low = coefficients, at
        else:
            high = at
    return BSpline(basis.knots, best, _DEGREE)


def _bending(basis: _Basis, share: float) -> float:
    """Weight of the bending as a share of that of the points."""
    points = float((basis.values.T @ basis.values).diagonal().mean())
    return share * points / float(basis.bending.diagonal().mean())


def _minimax(
    basis: _Basis, y: Array, half_width: Array, weights: Array, bending: float
) -> tuple[Array, Array]:
    """Fit, with more weight on the points farthest off in their boxes; the best of some rounds.

    Returns:
        Coefficients, and the ratio of each point's distance to its half width, shape (n,).
    """
    best, least = None, np.full(len(y), np.inf)
    for _ in range(_MINIMAX):
        coefficients = basis.fit(y, weights, bending)
        off = np.abs((basis.values @ coefficients - y) / half_width).max(axis=1)
        if best is None or off.max() < least.max():
            best, least = coefficients, off
        if off.max() <= 1.0 or off.max() > 3.0:
            break
        weights = weights * (0.2 + off / off.max())
        weights /= weights.mean()
    assert best is not None
    return best, least


def _divided(breaks: Array, u: Array, off: Flags) -> Array | None:
    """Breaks with the spans halved in which points are off; None: they have too few points."""
    span = np.clip(np.searchsorted(breaks, u, "right") - 1, 0, len(breaks) - 2)
    count = np.bincount(span, minlength=len(breaks) - 1)
    bad = np.unique(span[off])
    bad = bad[count[bad] >= 3]
    if len(bad) == 0:
        return None
    middles = 0.5 * (breaks[bad] + breaks[bad + 1])
    return np.sort(np.concatenate([breaks, middles]))
