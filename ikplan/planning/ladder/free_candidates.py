"""Candidates and sequences that are free of contact."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.planning.ladder.ik_candidates import IkCandidates
from ikplan.planning.ladder.motion_cost import MotionCost, posture_distances

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
    cost: MotionCost,
    price: Callable[[int, Array, Array], float],
    charges: Sequence[Array] | None = None,
) -> Array | None:
    """Return the shortest sequence of candidates whose motions are free, or None.

    Motions are looked at only where a shortest sequence uses them (lazy evaluation of edges,
    R. Bohlin and L. E. Kavraki, "Path planning using lazy PRM", 2000): one in contact is left
    out, another becomes longer by its price, and the search goes on.

    Args:
        candidates: Solutions of each of n targets, one at least.
        q_start: Where the arm is, shape (dof,) [rad or m].
        start_free: Whether the motion begins at the first target.
        cost: What a sequence costs.
        price: What the straight motion to target k costs beside its length, from one
            configuration to another: ``price(k, q_before, q)``, inf where it is in contact, at
            least 0 [rad or m].
        charges: What is known to be charged beside that, at the start, shape (1,), and at the
            candidates of each target, shape (c,): a motion is charged the larger one of its ends.
            None: nothing.

    Returns:
        Configurations, shape (n, dof) [rad or m]; None: there is none, or it was not found within
        the bounded number of checks.
    """
    rows = [candidates.q[k, :count] for k, count in enumerate(candidates.counts)]
    lengths = [np.linalg.norm(cost.weights * (rows[0] - q_start), axis=1)[None]]
    if start_free:
        lengths[0] = np.zeros_like(lengths[0])
    for before, after in itertools.pairwise(rows):
        steps = cost.weights * (before[:, None] - after[None])
        lengths.append(np.linalg.norm(steps, axis=2))
    for step, row in zip(lengths, rows, strict=True):
        step += posture_distances(row, cost) / len(rows)
    if charges is not None:
        if start_free:
            charges = [np.zeros(1), *charges[1:]]
        for step, (before, after) in zip(lengths, itertools.pairwise(charges), strict=True):
            step += np.maximum(before[:, None], after[None])
    priced: set[tuple[int, int, int]] = set()
    for _ in range(_ROUNDS):
        chosen = _shortest(lengths)
        if chosen is None:
            return None
        dearer = False
        for k, (i, j) in enumerate(zip([0, *chosen], chosen, strict=False)):
            if (k == 0 and start_free) or (k, i, j) in priced:
                continue
            extra = price(k, q_start if k == 0 else rows[k - 1][i], rows[k][j])
            priced.add((k, i, j))
            if extra > 0.0:
                lengths[k][i, j] += extra
                dearer = True
                if extra == np.inf:
                    break
        if not dearer:
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
