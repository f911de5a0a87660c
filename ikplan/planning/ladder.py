"""The least joint motion through one candidate per waypoint: shortest paths over the ladder.

The shortest path over the candidates is not always the one that is shortest after the polish, so
several that really differ are offered.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel
from ikplan.planning.candidates import Candidates

__all__ = ["distinct_paths"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@kernel
def _distance(a: Array, b: Array) -> float:
    total = 0.0
    for d in range(a.shape[0]):
        total += (a[d] - b[d]) ** 2
    return math.sqrt(total)


@kernel
def _climb(candidates: Candidates, q_start: Array, start_free: bool) -> tuple[Array, Indices]:
    """Least joint motion from the start to every candidate, and the candidate before it there.

    Returns:
        Costs, shape (n, cap), inf where there is no candidate, and parents, shape (n, cap).
    """
    n, cap, _ = candidates.q.shape
    cost = np.full((n, cap), np.inf)
    parent = np.zeros((n, cap), dtype=np.int64)
    for j in range(candidates.counts[0]):
        cost[0, j] = 0.0 if start_free else _distance(candidates.q[0, j], q_start)
    for k in range(1, n):
        for j in range(candidates.counts[k]):
            for i in range(candidates.counts[k - 1]):
                if cost[k - 1, i] < cost[k, j]:
                    total = cost[k - 1, i] + _distance(candidates.q[k, j], candidates.q[k - 1, i])
                    if total < cost[k, j]:
                        cost[k, j] = total
                        parent[k, j] = i
    return cost, parent


@kernel
def _descend(candidates: Candidates) -> tuple[Array, Indices]:
    """Least joint motion from every candidate to the end, and the candidate after it there."""
    n, cap, _ = candidates.q.shape
    cost = np.full((n, cap), np.inf)
    child = np.zeros((n, cap), dtype=np.int64)
    for j in range(candidates.counts[n - 1]):
        cost[n - 1, j] = 0.0
    for back in range(n - 1):
        k = n - 2 - back
        for j in range(candidates.counts[k]):
            for i in range(candidates.counts[k + 1]):
                if cost[k + 1, i] < cost[k, j]:
                    total = cost[k + 1, i] + _distance(candidates.q[k, j], candidates.q[k + 1, i])
                    if total < cost[k, j]:
                        cost[k, j] = total
                        child[k, j] = i
    return cost, child


@kernel
def distinct_paths(
    candidates: Candidates, q_start: Array, start_free: bool, most: int, apart: float, slack: float
) -> Array:
    """Return the shortest paths over the ladder that really differ, shortest first.

    Every candidate has a shortest path through it; they are taken in order of length, leaving out
    those that stay near to one taken already.

    Args:
        candidates: Candidates of each waypoint; each waypoint has at least one.
        q_start: The start, shape (dof,) [rad or m].
        start_free: Whether the motion may begin at any candidate of the first waypoint.
        most: Most paths to return.
        apart: Paths differ when some joint is this far apart at some waypoint [rad or m].
        slack: Paths longer than (1 + slack) times the shortest are left out.

    Returns:
        Paths, shape (m, n, dof), 1 <= m <= most [rad or m].
    """
    n, cap, dof = candidates.q.shape
    up, parent = _climb(candidates, q_start, start_free)
    down, child = _descend(candidates)
    through = (up + down).reshape(n * cap)
    order = np.argsort(through, kind="mergesort")
    paths = np.empty((most, n, dof))
    found = 0
    for at in order:
        if found == most or not through[at] <= (1.0 + slack) * through[order[0]]:
            break
        middle, j = at // cap, at % cap
        i = j
        for back in range(middle + 1):
            k = middle - back
            paths[found, k] = candidates.q[k, i]
            i = parent[k, i]
        i = j
        for k in range(middle, n):
            paths[found, k] = candidates.q[k, i]
            i = child[k, i]
        new = True
        for other in range(found):
            largest = 0.0
            for k in range(n):
                for d in range(dof):
                    largest = max(largest, abs(paths[found, k, d] - paths[other, k, d]))
            if largest < apart:
                new = False
                break
        if new:
            found += 1
    return paths[:found]
