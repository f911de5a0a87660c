"""Compiled greatest uses of limits over intervals, between the points that are looked at too."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["highest_between"]


@kernel
def highest_between(ratios: Array) -> Array:
    """Return the greatest values of the parabolas through three neighbours each.

    Args:
        ratios: At equally spaced points, three or more, shape (p, n).

    Returns:
        With the values at the points among them, shape (n,).
    """
    points, n = ratios.shape
    out: Array = np.maximum(ratios[0], ratios[points - 1])
    for k in range(1, points - 1):
        first, middle, last = ratios[k - 1], ratios[k], ratios[k + 1]
        for i in range(n):
            curvature = first[i] - 2.0 * middle[i] + last[i]
            slope = 0.5 * (last[i] - first[i])
            # The vertex is between the outer ones of the three, or there is no maximum to be found.
            inner = -curvature > abs(slope)
            rise = slope * slope / (-2.0 * curvature) if inner else 0.0
            out[i] = max(out[i], middle[i] + rise)
    return out
