"""The shortest way over a ladder whose steps are looked at only where they may be on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ikplan.arrays import Array, Indices

__all__ = ["Join", "shortest_way"]

Join = Callable[[int, Array, Array, Array], tuple[Array, Indices, Array]]
"""``join(k, cost, q_before, q)``: how the candidates of rung k are reached from those of the rung
before, to which the ways are ``cost`` long: the length of the way to each, inf where there is none;
the candidate before it; and the configuration half-way."""


def shortest_way(rungs: Sequence[Array], costs: Array, join: Join) -> tuple[Array, Array] | None:
    """Return the shortest way from the first rung to the last, or None.

    Args:
        rungs: Candidates of each rung, shape (c, dof) [rad or m].
        costs: Joint motion already spent to get to each of the first, shape (c,).
        join: Reaches the candidates of one rung.

    Returns:
        Configurations of the rungs, shape (n, dof), and those half-way between, shape
        (n - 1, dof); None: no way was found.
    """
    cost = np.array(costs, dtype=np.float64)
    parents, middles = list[Indices](), list[Array]()
    for k in range(1, len(rungs)):
        cost, parent, middle = join(k, cost, rungs[k - 1], rungs[k])
        if not np.isfinite(cost).any():
            return None
        parents.append(parent)
        middles.append(middle)
    at = int(np.argmin(cost))
    chosen, between = [rungs[-1][at]], list[Array]()
    for k in range(len(rungs) - 1, 0, -1):
        between.append(middles[k - 1][at])
        at = int(parents[k - 1][at])
        chosen.append(rungs[k - 1][at])
    dof = rungs[0].shape[1]
    return np.array(chosen[::-1]), np.array(between[::-1]).reshape(-1, dof)
