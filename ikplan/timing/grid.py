"""Where the nodes of a timing go."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices, steps_of
from ikplan.joint_path.joint_path import JointPath

__all__ = ["Grid", "curvature_grid", "regridded"]


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes along a span of a path, every knot of the span among them.

    Attributes:
        s: Path positions of the nodes, shape (n + 1,), strictly increasing.
        pieces: Piece of the path that each interval belongs to, shape (n,).
    """

    s: Array
    pieces: Indices


@kernel
def _place(s: Array, pieces: Indices, counts: Array) -> tuple[Array, Indices]:
    """Divide each run of intervals of one piece into about as many intervals as given."""
    n = len(pieces)
    total = 0
    for i in range(n):
        total += int(counts[i]) + 1
    nodes, owner = np.empty(total + 1), np.empty(total, np.int64)
    count, start = 0, 0
    while start < n:
        stop, mass = start, 0.0
        while stop < n and pieces[stop] == pieces[start]:
            mass += counts[stop]
            stop += 1
        parts = max(int(np.ceil(mass - 1e-9)), 1)
        i, before = start, 0.0
        for part in range(parts):
            level = mass * part / parts
            while i < stop - 1 and before + counts[i] <= level:
                before += counts[i]
                i += 1
            share = (level - before) / counts[i]
            nodes[count] = s[i] + (s[i + 1] - s[i]) * min(max(share, 0.0), 1.0)
            owner[count] = pieces[start]
            count += 1
        start = stop
    nodes[count] = s[n]
    return nodes[: count + 1].copy(), owner[:count].copy()


def regridded(grid: Grid, counts: Array, kept: Array | None = None) -> Grid:
    """Return a grid with about as many intervals as given in place of each interval.

    Args:
        grid: The old grid.
        counts: Number of intervals in place of each, > 0, fractions allowed, shape (n,).
        kept: Nodes that stay, all ends of pieces among them, in order; None: only those.

    Returns:
        The new grid; it keeps these nodes and no others of the old one.
    """
    runs = grid.pieces if kept is None else np.searchsorted(kept, grid.s[:-1], "right")
    s, pieces = _place(grid.s.copy(), runs, counts)  # one compiled kind of arrays
    if kept is not None:
        pieces = grid.pieces[np.searchsorted(runs, pieces)]
    # A node that rounding put on its neighbour would be an interval of length zero.
    distinct = np.append(steps_of(s) > 0.0, True)
    return Grid(s[distinct], pieces[distinct[:-1]])


def curvature_grid(path: JointPath, knots: Sequence[int], weight: Array, target: int) -> Grid:
    """Place nodes by how much the direction of motion turns, and evenly otherwise.

    Args:
        path: The path.
        knots: First and last knot of the span; of spans that are timed together, all their ends.
        weight: How much each joint counts, shape (dof,).
        target: About how many intervals in each span.

    Returns:
        The grid.
    """
    first, last = knots[0], knots[-1]
    s = path.s_knots[first : last + 1]
    h = steps_of(s)
    m0, m1 = path.tangents_start[first:last], path.tangents_end[first:last]
    d = steps_of(path.q_knots[first : last + 1]) / h[:, None]
    turn = np.sqrt(
        np.sum((np.abs(d - m0) + np.abs(m1 - d)) * weight, axis=1)
        / np.maximum(np.sum(np.abs(d) * weight, axis=1), 1e-300)
    )
    density = np.empty_like(h)
    for begin, end in itertools.pairwise(knots):
        span = slice(begin - first, end - first)
        of_turn = max(float(turn[span].sum()), 1e-300)
        density[span] = h[span] / h[span].sum() + turn[span] / of_turn
    counts = np.maximum(0.5 * target * density, 2.0)
    return regridded(Grid(s, np.arange(first, last)), counts)
