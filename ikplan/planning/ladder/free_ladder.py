"""The shortest way over a ladder whose steps are looked at only where they may be on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ikplan.arrays import Array

__all__ = ["Step", "shortest_way"]

_TRIED = 12
"""Steps to a candidate that are looked at, shortest way first, before it is given up."""

Step = Callable[[int, Array, Array], Array | None]
"""``step(k, q_before, q)``: the configuration half-way of the step from rung k - 1 to rung k, or
None where the arm cannot take it."""


def shortest_way(
    rungs: Sequence[Array], costs: Array, longest: float, step: Step
) -> tuple[Array, Array] | None:
    """Return the shortest way from the first rung to the last, or None.

    Rung by rung, every candidate is reached by the shortest way whose last step can be taken; steps
    are looked at in order of the way's length, so that few are.

    Args:
        rungs: Candidates of each rung, shape (c, dof) [rad or m].
        costs: Joint motion already spent to get to each of the first, shape (c,).
        longest: How far a joint may move in a step [rad or m].
        step: Tells whether a step can be taken.

    Returns:
        Configurations of the rungs, shape (n, dof), and those half-way between, shape
        (n - 1, dof); None: no way was found.
    """
    cost = np.array(costs, dtype=np.float64)
    parents: list[list[int]] = []
    middles: list[list[Array | None]] = []
    for k in range(1, len(rungs)):
        before, after = rungs[k - 1], rungs[k]
        reached = np.full(len(after), np.inf)
        parent, middle = [-1] * len(after), list[Array | None]([None] * len(after))
        for j, q in enumerate(after):
            gap = before - q
            total = cost + np.linalg.norm(gap, axis=1)
            total[np.abs(gap).max(axis=1, initial=0.0) > longest] = np.inf
            for i in np.argsort(total, kind="stable")[:_TRIED]:
                if not np.isfinite(total[i]):
                    break
                half_way = step(k, before[i], q)
                if half_way is not None:
                    reached[j], parent[j], middle[j] = total[i], int(i), half_way
                    break
        if not np.isfinite(reached).any():
            return None
        cost = reached
        parents.append(parent)
        middles.append(middle)
    at = int(np.argmin(cost))
    chosen, between = [rungs[-1][at]], list[Array]()
    for k in range(len(rungs) - 1, 0, -1):
        half = middles[k - 1][at]
        assert half is not None
        between.append(half)
        at = parents[k - 1][at]
        chosen.append(rungs[k - 1][at])
    dof = rungs[0].shape[1]
    return np.array(chosen[::-1]), np.array(between[::-1]).reshape(-1, dof)
