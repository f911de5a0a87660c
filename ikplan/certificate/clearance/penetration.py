"""How deep two bodies are in each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["depth_at_most"]

Array = NDArray[np.float64]

_DIRECTIONS = 1000
_ROUNDS = 80
_AROUND = 32
_SHRINK = 0.6


def _spread(count: int) -> Array:
    """Directions spread evenly over the sphere by the golden angle, shape (count, 3)."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    turn = np.pi * (1.0 + np.sqrt(5.0)) * k
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)


def depth_at_most(first: Array, second: Array, radii: float) -> float:
    """Bound how deep two hulls with radii overlap: a shift by so much takes them apart.

    The overlap along any direction is such a shift; the smallest one is sought among even
    directions and then around the best.

    Args:
        first: Corners of one hull, shape (n, 3) [m].
        second: Corners of the other, shape (m, 3) [m], same frame.
        radii: Sum of the radii around them [m].

    Returns:
        The depth, at least 0 [m].
    """

    def overlap(v: Array) -> Array:
        reach: Array = (v @ first.T).max(axis=1) - (v @ second.T).min(axis=1)
        return reach

    even = _spread(_DIRECTIONS)
    values = overlap(even)
    best, least = even[np.argmin(values)], float(values.min())
    around, width = _spread(_AROUND), 2.0 / np.sqrt(_DIRECTIONS) * np.sqrt(np.pi)
    for _ in range(_ROUNDS):
        tried = best + width * around
        tried /= np.linalg.norm(tried, axis=1)[:, None]
        values = overlap(tried)
        if values.min() < least:
            best, least = tried[np.argmin(values)], float(values.min())
        else:
            width *= _SHRINK
    return max(least + radii, 0.0)
