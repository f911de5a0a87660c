"""Candidates and sequences that are free of contact."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.planning.ladder.ik_candidates import IkCandidates

__all__ = ["keep_free", "shortest_free_sequence"]

_ROUNDS = 400
"""Sequences whose motions are checked before the search gives up."""


def keep_free(candidates: IkCandidates, free: Callable[[Array], Flags]) -> None:
    """Drop the candidates of each target that are in contact, in place; the order stays.

    Args:
        candidates: Solutions of each target.
        free: Tells which configurations, shape (c, dof), are free, shape (c,).
    """
    for k, count in enumerate(candidates.counts):
        kept = candidates.q[k, :count][free(candidates.q[k, :count])]
        candidates.q[k, : len(kept)] = kept
        candidates.counts[k] = len(kept)


def shortest_free_sequence(
    candidates: IkCandidates,
    q_start: Array,
    start_free: bool,
    is_free: Callable[[int, Array, Array], bool],
    prices: Sequence[Array] | None = None,
) -> Array | None:
    """Return the shortest sequence of candidates whose motions are free, or None.

    Motions are checked only where a shortest sequence uses them (lazy evaluation of edges,
    R. Bohlin and L. E. Kavraki, "Path planning using lazy PRM", 2000): one in contact is left
    out, and the search goes on.

    Args:
        candidates: Solutions of each of n targets, one at least.
        q_start: Where the arm is, shape (dof,) [rad or m].
        start_free: Whether the motion begins at the first target.
        is_free: Whether the straight motion to target k, from one configuration to another, is
            free: ``is_free(k, q_before, q)``.
        prices: What each candidate of each target costs beside the motion to it, as joint motion,
            shape (c,) each; None: nothing.

    Returns:
        Configurations, shape (n, dof) [rad or m]; None: there is none, or it was not found within
        the bounded number of checks.
    """
    rows = [candidates.q[k, :count] for k, count in enumerate(candidates.counts)]
    lengths = [np.linalg.norm(rows[0] - q_start, axis=1)[None]]
    if start_free:
        lengths[0] = np.zeros_like(lengths[0])
    for before, after in itertools.pairwise(rows):
        lengths.append(np.linalg.norm(before[:, None] - after[None], axis=2))
    if prices is not None:
        lengths = [step + price for step, price in zip(lengths, prices, strict=True)]
    proven: set[tuple[int, int, int]] = set()
    for _ in range(_ROUNDS):
        chosen = _shortest(lengths)
        if chosen is None:
            return None
        refused = False
        for k, (i, j) in enumerate(zip([0, *chosen], chosen, strict=False)):
            if (k == 0 and start_free) or (k, i, j) in proven:
                continue
            if not is_free(k, q_start if k == 0 else rows[k - 1][i], rows[k][j]):
                lengths[k][i, j] = np.inf
                refused = True
                break
            proven.add((k, i, j))
        if not refused:
            return np.array([rows[k][j] for k, j in enumerate(chosen)])
    return None


def _shortest(lengths: list[Array]) -> list[int] | None:
    """The candidate of each target on the shortest path over the ladder; None: there is none."""
    cost = np.zeros(1)
    parents = []
    for step in lengths:
        total = cost[:, None] + step
        parents.append(np.argmin(total, axis=0))
        cost = total.min(axis=0)
    at = int(np.argmin(cost))
    if not np.isfinite(cost[at]):
        return None
    chosen = []
    for parent in reversed(parents):
        chosen.append(at)
        at = int(parent[at])
    return chosen[::-1]
