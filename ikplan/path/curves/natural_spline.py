"""The cubic spline through points that has no curvature at its ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan.arrays import Array

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

__all__ = ["natural_spline"]


def natural_spline(x: Array, y: Array) -> CubicSpline:
    """Return the spline through ``y``, shape (k, ...), at increasing ``x``, shape (k,)."""
    from scipy.interpolate import CubicSpline  # slow to import

    return CubicSpline(x, y, axis=0, bc_type="natural")
