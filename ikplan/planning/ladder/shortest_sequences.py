"""Joint sequences through targets one after the other: candidates of each, the shortest motions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ikplan.arrays import Array
from ikplan.kinematics.arm import Arm
from ikplan.planning.ladder.ik_candidates import IkCandidates, Targets, sample_ik_solutions
from ikplan.planning.ladder.ladder_graph import diverse_shortest_paths
from ikplan.planning.ladder.motion_cost import MotionCost
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.time_budget import TimeBudget

__all__ = ["ik_candidates", "shortened_sequences"]


_CAP = 40
"""Candidates kept of a target."""
_FIRST = 100
"""Evenly spread seeds of the first target, and of one far from the one before."""
_FRESH = 4
"""Evenly spread seeds of every further target."""
_PATHS = 6
"""Paths over the ladder that are shortened."""
_EXACT = 1e-9
"""Error that counts as none [m and rad]."""


def ik_candidates(
    arm: Arm,
    targets: Targets,
    q_start: Array,
    clock: TimeBudget,
    seeds: Array | None = None,
    seed: int = 0,
) -> IkCandidates:
    """Return a diverse set of solutions of each of n targets.

    Args:
        arm: The arm.
        targets: The targets.
        q_start: Where the arm is, shape (dof,) [rad or m].
        clock: Counts the evaluations.
        seeds: Configurations to begin from at each target, shape (n, k, dof); None: none.
        seed: Which series of evenly spread seeds.
    """
    if seeds is None:
        seeds = np.empty((len(targets.p), 0, arm.dof))
    candidates = sample_ik_solutions(
        arm.chain,
        targets,
        seeds,
        q_start,
        arm.lower,
        arm.upper,
        _CAP,
        _FIRST,
        _FRESH,
        (0.5 + seed * 0.6180339887498949) % 1.0,
        _EXACT,
        arm.closed_form,
    )
    clock.count(int(candidates.evaluations[0]))
    return candidates


def shortened_sequences(
    arm: Arm,
    targets: Targets,
    candidates: IkCandidates,
    q_start: Array,
    start_free: bool,
    cost: MotionCost,
    clock: TimeBudget,
) -> Iterator[tuple[float, Array]]:
    """Yield the shortest paths over the candidates that really differ, each shortened.

    Args:
        arm: The arm.
        targets: The n targets.
        candidates: Solutions of each, one at least.
        q_start: Where the arm is, shape (dof,) [rad or m].
        start_free: Whether the motion begins at the first target.
        cost: What a sequence costs.
        clock: Counts the evaluations.

    Yields:
        Cost [rad or m] and configurations, shape (n, dof).
    """
    lower, upper = arm.lower, arm.upper
    for q in diverse_shortest_paths(
        arm.chain, candidates, q_start, start_free, lower, upper, cost, _PATHS, 0.6, 0.1
    ):
        length, spent = shorten_sequence(
            arm.chain, targets, q, q_start, start_free, lower, upper, cost, 60, 1e-5
        )
        clock.count(spent)
        yield length, q
