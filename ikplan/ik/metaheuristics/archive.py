"""An archive of candidates of two objectives, none of which dominates another.

Source: Coello Coello, Pulido, Lechuga, IEEE Transactions on Evolutionary Computation 2004, 8(3);
crowding distance of Deb et al., "NSGA-II", 2002.
"""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.order import ascending

__all__ = ["archive_into", "crowding", "dominates", "draw_leader", "knee"]


@kernel
def dominates(a1: float, a2: float, b1: float, b2: float) -> bool:
    """Whether objectives (a1, a2) are no worse than (b1, b2) in both and better in one."""
    return a1 <= b1 and a2 <= b2 and (a1 < b1 or a2 < b2)


@kernel
def crowding(G: Array) -> Array:
    """Return the crowding distances of objectives G, shape (k, 2); infinite at the ends."""
    k = G.shape[0]
    distance = np.zeros(k)
    for m in range(2):
        order = ascending(G[:, m].copy())
        span = G[order[k - 1], m] - G[order[0], m]
        distance[order[0]] = np.inf
        distance[order[k - 1]] = np.inf
        if span > 0.0:
            for j in range(1, k - 1):
                distance[order[j]] += (G[order[j + 1], m] - G[order[j - 1], m]) / span
    return distance


@kernel
def archive_into(room: Array, size: int, X: Array, G: Array, capacity: int) -> int:
    """Add a swarm to the archive, and keep what is not dominated.

    Args:
        room: The archive: rows of position, f1, f2, shape (capacity + N, D + 2).
        size: Rows in use.
        X: Positions to be added, shape (N, D).
        G: Their objectives, shape (N, 2).
        capacity: Largest number of rows kept; the most crowded ones go.

    Returns:
        Rows in use now.
    """
    D = X.shape[1]
    for i in range(X.shape[0]):
        kept, f1, f2 = True, G[i, 0], G[i, 1]
        for m in range(size):
            if dominates(room[m, D], room[m, D + 1], f1, f2):
                kept = False
                break
        if not kept:
            continue
        left = 0
        for m in range(size):
            if not dominates(f1, f2, room[m, D], room[m, D + 1]):
                if left != m:
                    room[left] = room[m]
                left += 1
        room[left, :D] = X[i]
        room[left, D:] = G[i]
        size = left + 1
    if size > capacity:
        distance = crowding(room[:size, D:].copy())
        gone = np.zeros(size, dtype=np.bool_)
        gone[ascending(distance)[: size - capacity]] = True
        left = 0
        for m in range(size):
            if not gone[m]:
                room[left] = room[m]
                left += 1
        size = capacity
    return size


@kernel
def draw_leader(G: Array, grid: int, rng: np.random.Generator) -> int:
    """Draw a leader: a grid cell by roulette, with weight 10 / its members, then a member.

    Args:
        G: Objectives of the archive, shape (k, 2).
        grid: Divisions of each objective.
        rng: Random numbers; two are drawn.
    """
    k = G.shape[0]
    cell = np.zeros(k, dtype=np.int64)
    for m in range(2):
        low, span = G[:, m].min(), G[:, m].max() - G[:, m].min()
        for i in range(k):
            place = int(grid * (G[i, m] - low) / span) if span > 0.0 else 0
            cell[i] = cell[i] * grid + min(place, grid - 1)
    members = np.zeros(grid * grid, dtype=np.int64)
    for i in range(k):
        members[cell[i]] += 1
    total = 0.0
    for c in range(grid * grid):
        if members[c] > 0:
            total += 10.0 / members[c]
    mark, chosen = rng.random() * total, -1
    for c in range(grid * grid):
        if members[c] > 0:
            chosen = c
            mark -= 10.0 / members[c]
            if mark < 0.0:
                break
    rank = int(rng.random() * members[chosen])
    leader = 0
    for i in range(k):
        if cell[i] == chosen:
            if rank == 0:
                leader = i
            rank -= 1
    return leader


@kernel
def knee(G: Array) -> int:
    """Return which of the objectives G, shape (k, 2), scaled to [0, 1], is nearest to (0, 0)."""
    least, index = np.inf, 0
    low0, low1 = G[:, 0].min(), G[:, 1].min()
    span0, span1 = G[:, 0].max() - low0, G[:, 1].max() - low1
    for i in range(G.shape[0]):
        a = (G[i, 0] - low0) / span0 if span0 > 0.0 else 0.0
        b = (G[i, 1] - low1) / span1 if span1 > 0.0 else 0.0
        if a * a + b * b < least:
            least, index = a * a + b * b, i
    return index
