"""Points closer to one another than a tolerance, taken as one, so that noise has no length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Indices

__all__ = ["Clusters", "clusters_of"]


_RANGE = 1.0
"""Widest range of the points of one cluster along an axis, as a share of the tolerance; of axes
that are held to it together, divided by the root of their number."""


@dataclass(frozen=True, eq=False)
class Clusters:
    """Runs of points that are as good as one.

    Attributes:
        middle: Middle of each cluster's range, shape (k, d); the first and the last point exactly.
        half_width: How far from the middle a curve may pass so that it is within the tolerance of
            every point of the cluster, shape (k, d).
        of_point: Cluster of each point, shape (n,).
        u: Length of the polyline through the middles up to each, shape (k,), increasing strictly.
    """

    middle: Array
    half_width: Array
    of_point: Indices
    u: Array


def clusters_of(points: Array, tolerance: Array, together: Sequence[int] | None = None) -> Clusters:
    """Return the clusters of successive points.

    Args:
        points: Points, shape (n, d), n >= 1.
        tolerance: How far a curve may pass from a point along each axis, shape (d,), positive.
        together: How many successive axes are held to it together, by the root of the sum of the
            squares; None: each by itself.
    """
    sizes = [1] * points.shape[1] if together is None else together
    first = np.append(0, np.cumsum(sizes)[:-1])
    widest = _RANGE / np.sqrt(sizes)
    scaled = points / tolerance
    of_point = np.zeros(len(points), dtype=np.int64)
    low, high = scaled[0].copy(), scaled[0].copy()
    lows, highs = [], []
    for i, row in enumerate(scaled):
        low_i, high_i = np.minimum(low, row), np.maximum(high, row)
        if (_wide(high_i - low_i, first) > widest).any():
            lows.append(low)
            highs.append(high)
            low_i, high_i = row.copy(), row.copy()
        low, high = low_i, high_i
        of_point[i] = len(lows)
    lows.append(low)
    highs.append(high)
    ranges = np.array(highs) - np.array(lows)
    middle = 0.5 * (np.array(highs) + np.array(lows))
    half_width = 1.0 - 0.5 * np.repeat(_wide(ranges, first), sizes, axis=-1)
    middle[0], middle[-1] = scaled[0], scaled[-1]
    if len(middle) == 1 and (scaled[0] != scaled[-1]).any():
        middle = np.array([scaled[0], scaled[-1]])
        half_width = np.vstack([half_width, half_width])
        of_point[-1] = 1
    # Only the ends differ from the middles of their clusters, and a curve begins and ends there.
    steps = np.linalg.norm(np.diff(middle, axis=0), axis=1)
    u = np.concatenate([[0.0], np.cumsum(np.maximum(steps, 1e-9))])
    return Clusters(middle * tolerance, half_width * tolerance, of_point, u)


def _wide(ranges: Array, first: Indices) -> Array:
    """Ranges along axes, shape (..., d), as those of the groups that begin at the first ones."""
    if len(first) == ranges.shape[-1]:
        return ranges
    return np.asarray(np.sqrt(np.add.reduceat(ranges * ranges, first, axis=-1)))
