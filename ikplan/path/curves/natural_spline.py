"""The cubic spline through points that has no curvature at its ends."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.path.curves.spline_kernels import natural_slopes

__all__ = ["NaturalSpline"]


class NaturalSpline:
    """The natural cubic spline through ``y`` at the knots ``x``.

    scipy's CubicSpline gives the same numbers, but its import takes longer than a plan.

    Args:
        x: Increasing knots, shape (k,), k >= 2.
        y: Values at them, shape (k, columns).

    Attributes:
        c: Coefficients since the knot before, highest power first, shape (4, k - 1, columns).

    Raises:
        ValueError: The knots do not increase, or a value is not finite.
    """

    def __init__(self, x: Array, y: Array) -> None:
        x, y = np.ascontiguousarray(x), np.ascontiguousarray(y)
        h = np.diff(x)[:, None]
        if not ((h > 0.0).all() and np.isfinite(x).all() and np.isfinite(y).all()):
            raise ValueError("the knots of a spline have to increase, and all values to be finite")
        slopes = natural_slopes(x, y)
        chord = np.diff(y, axis=0) / h
        bend = (slopes[:-1] + slopes[1:] - 2.0 * chord) / h
        self._x = x
        self.c: Array = np.array([bend / h, (chord - slopes[:-1]) / h - bend, slopes[:-1], y[:-1]])

    def __call__(self, at: Array) -> Array:
        """Return the spline at parameters, shape (m,), as shape (m, columns).

        Beyond the knots the first and the last piece go on.
        """
        span = np.searchsorted(self._x[1:-1], at, side="right")
        t = (at - self._x[span])[:, None]
        cubic, square, slope, value = self.c[:, span]
        spline: Array = value + slope * t + square * (t * t) + cubic * (t * t * t)
        return spline
