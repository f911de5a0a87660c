"""Where the nodes of a timing go."""

from __future__ import annotations

import numpy as np

from ikplan.timing.joint_path import JointPath
from ikplan.timing.limits import JointLimits
from ikplan.timing.rows import Grid

__all__ = ["curvature_grid", "split"]


def split(path: JointPath, first: int, counts: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Grid:
    """Divide pieces of a path into equal intervals.

    Args:
        path: The path.
        first: First piece.
        counts: Number of intervals of each piece from there on, shape (k,), >= 1.

    Returns:
        The grid, every knot on it.
    """
    k = len(counts)
    pieces = np.repeat(np.arange(first, first + k), counts)
    offset = np.arange(len(pieces)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = offset / np.repeat(counts, counts)
    start, end = path.s_knots[pieces], path.s_knots[pieces + 1]
    s = np.append(start + share * (end - start), path.s_knots[first + k])
    return Grid(s, pieces)


def curvature_grid(
    path: JointPath, first: int, last: int, limits: JointLimits, target: int
) -> Grid:
    """Place nodes by how much the direction of motion turns, and evenly otherwise.

    Args:
        path: The path.
        first: First knot of the span.
        last: Last knot of the span.
        limits: Joint limits: joints count by their share of the acceleration limit.
        target: About how many intervals.

    Returns:
        The grid.
    """
    h = np.diff(path.s_knots[first : last + 1])
    m0, m1 = path.tangents_start[first:last], path.tangents_end[first:last]
    d = np.diff(path.q_knots[first : last + 1], axis=0) / h[:, None]
    weight = 1.0 / np.minimum(limits.acceleration, -limits.acceleration_lower)
    turn = np.sum((np.abs(d - m0) + np.abs(m1 - d)) * weight, axis=1)
    size = np.maximum(np.sum(np.abs(d) * weight, axis=1), 1e-300)
    density = h / h.sum() + np.sqrt(turn / size) / max(np.sqrt(turn / size).sum(), 1e-300)
    counts = np.ceil(0.5 * target * density).astype(np.int64)
    return split(path, first, np.maximum(counts, 2))
