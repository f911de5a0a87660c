"""The cubic spline of least bending found that stays near each point, in a box or in a ball.

A penalised spline (Eilers and Marx, Flexible smoothing with B-splines and penalties, Statistical
Science 11, 1996, with the integral of the squared second derivative as the penalty): least squares
on few knots, which are added where the curve is too far from a point; then the weight of the
bending is raised as far as the points allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.smoothing.box_fit_kernels import BANDS, minimax_fit

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

__all__ = ["fit_within"]


_DEGREE = 3
_FIRST_SPANS = 4
_ROUNDS = 40
_LEAST_BENDING = 1e-9
"""Weight of the bending, as a share of that of the points, that only keeps the system regular."""
_DECADES = 14.0
_BISECTIONS = 22
_MINIMAX = 12
"""Rounds in which the points farthest off get more weight (C. L. Lawson, 1961)."""


class _Points(NamedTuple):
    """Points to pass near, and how near; see :func:`fit_within`.

    Attributes:
        y: The points, shape (n, d).
        half_width: How far the curve may be from them along each axis, shape (n, d).
        group: Number of the group of each axis, shape (d,).
    """

    y: Array
    half_width: Array
    group: Indices


@dataclass(frozen=True, eq=False)
class _Basis:
    """Cubic B-splines on knots.

    Attributes:
        knots: The knots, with those repeated at the ends.
        first: Index of the first spline that is not zero at each point, shape (n,).
        values: The values of it and the next ones there, shape (n, BANDS).
        bending: Lower bands of the integral of the squared second derivative, shape (m, BANDS).
    """

    knots: Array
    first: Indices
    values: Array
    bending: Array

    @classmethod
    def on(cls, breaks: Array, u: Array) -> _Basis:
        from scipy.interpolate import BSpline  # slow to import
        from scipy.sparse import csr_array, diags_array

        k = _DEGREE
        t = np.concatenate([np.repeat(breaks[0], k), breaks, np.repeat(breaks[-1], k)])
        m = len(t) - k - 1
        design = BSpline.design_matrix(u, t, k)
        # From coefficients to those of the second derivative, a spline of degree 1.
        first = k / (t[k + 1 : k + m] - t[1:m])
        second = (k - 1) / (t[k + 1 : k + m - 1] - t[2:m])
        d1 = diags_array([-first, first], offsets=[0, 1], shape=(m - 1, m))
        d2 = diags_array([-second, second], offsets=[0, 1], shape=(m - 2, m - 1))
        h = np.diff(breaks)
        main = (np.append(h, 0.0) + np.append(0.0, h)) / 3.0
        gram = diags_array([h / 6.0, main, h / 6.0], offsets=[-1, 0, 1])
        bend = csr_array(d2 @ d1)
        whole = csr_array(bend.T @ gram @ bend)
        bands = np.zeros((m, BANDS))
        for band in range(BANDS):
            bands[: m - band, band] = whole.diagonal(-band)
        of_points = np.asarray(design.indices[::BANDS], dtype=np.int64)
        return cls(t, of_points, np.ascontiguousarray(design.data.reshape(-1, BANDS)), bands)

    def weight_of_bending(self, share: float) -> float:
        """Weight of the bending, of a share of that of the points."""
        points = float((self.values**2).sum()) / len(self.bending)
        return share * points / float(self.bending[:, 0].mean())

    def minimax(self, near: _Points, bending: float, rounds: int = _MINIMAX) -> tuple[Array, Array]:
        """Fit points; see :func:`ikplan.smoothing.box_fit_kernels.minimax_fit`."""
        return minimax_fit(self.first, self.values, self.bending, *near, bending, rounds)


def fit_within(
    u: Array, y: Array, half_width: Array, together: Sequence[int] | None = None
) -> BSpline:
    """Return a cubic spline that passes near each point and bends little.

    It begins at the first point and ends at the last one exactly.

    Args:
        u: Parameters of the points, shape (n,), n >= 2, increasing strictly.
        y: Points, shape (n, d).
        half_width: How far the curve may be from them along each axis, shape (n, d), positive.
        together: How many successive axes are held to their half widths together, by the root of
            the sum of the squares: a ball; None: each by itself, a box.
    """
    from scipy.interpolate import BSpline

    sizes = np.ones(y.shape[1], dtype=np.int64) if together is None else np.array(together)
    near = _Points(y, half_width, np.repeat(np.arange(len(sizes)), sizes))
    breaks = np.linspace(u[0], u[-1], _FIRST_SPANS + 1)
    basis = _Basis.on(breaks, u)
    least = _LEAST_BENDING
    for _ in range(_ROUNDS):
        weight = basis.weight_of_bending(least)
        coefficients, off = basis.minimax(near, weight)
        if off.max() <= 1.0:
            break
        divided = _divided(breaks, u, off > 1.0)
        if divided is None:
            # Every span is as short as the points allow: pass through them.
            breaks, least = u, 1e-3 * least
            basis = _Basis.on(breaks, u)
            weight = basis.weight_of_bending(least)
            coefficients, _ = basis.minimax(near, weight, rounds=1)
            break
        breaks = divided
        basis = _Basis.on(breaks, u)
    best = coefficients
    low, high = 0.0, _DECADES
    for _ in range(_BISECTIONS):
        at = 0.5 * (low + high)
        weight = basis.weight_of_bending(least)
        coefficients, off = basis.minimax(near, weight * 10.0**at)
        if off.max() <= 1.0:
            best, low = coefficients, at
        else:
            high = at
    return BSpline(basis.knots, best, _DEGREE)


def _divided(breaks: Array, u: Array, off: Flags) -> Array | None:
    """Breaks with the spans halved in which points are off; None: they have too few points.

    Where no such span has points enough, the points that are off and those beside them are breaks.
    """
    span = np.clip(np.searchsorted(breaks, u, "right") - 1, 0, len(breaks) - 2)
    count = np.bincount(span, minlength=len(breaks) - 1)
    bad = np.unique(span[off])
    bad = bad[count[bad] >= 3]
    if len(bad):
        middles = 0.5 * (breaks[bad] + breaks[bad + 1])
        return np.sort(np.concatenate([breaks, middles]))
    at = np.flatnonzero(off)
    beside = np.unique(np.clip(np.concatenate([at - 1, at, at + 1]), 0, len(u) - 1))
    more = np.union1d(breaks, u[beside])
    return more if len(more) > len(breaks) else None
