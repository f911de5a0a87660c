"""How deep two convex pieces are in each other: for a verdict, never inside a search."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array

__all__ = ["overlap_depth"]


def overlap_depth(first: Array, second: Array) -> float:
    """Return the length of the shortest shift that takes two overlapping hulls apart.

    The differences of their points span the shifts at which they meet; the depth is the distance
    from no shift to the nearest face of that hull, exact but for rounding (S. Cameron and
    R. K. Culley, "Determining the minimum translational distance between two convex polyhedra",
    ICRA 1986).

    Args:
        first: Points of one, shape (n, 3) [m].
        second: Points of the other, shape (m, 3) [m], same frame.

    Returns:
        The depth [m]; 0 where they do not overlap, or lie in one plane.
    """
    from scipy.spatial import ConvexHull, QhullError  # slow to import

    differences = _corners(first)[:, None] - _corners(second)[None]
    try:
        faces = ConvexHull(differences.reshape(-1, 3)).equations
    except QhullError:  # flat: any shift off the plane takes them apart
        return 0.0
    return max(float((-faces[:, 3]).min()), 0.0)


def _corners(points: Array) -> Array:
    """Those of some points that are corners of their hull."""
    if len(points) <= 8:
        return points
    from scipy.spatial import ConvexHull, QhullError  # slow to import

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points
