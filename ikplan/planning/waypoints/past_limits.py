"""Targets met at a joint limit, within the tolerance, where exactness costs a flip.

A target that a joint would meet by passing its limit by a hair is met exactly on another branch or
a full turn away only. The limit itself is then as good, as far as the tolerance allows.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.target import fixed_rows
from ikplan.planning.ladder.equivalent_configurations import with_equivalents
from ikplan.planning.ladder.ik_candidates import IkCandidates, Targets
from ikplan.planning.ladder.shortest_sequences import ik_candidates, shortened_sequences
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.planning.within.window_kernels import linearised_errors

__all__ = ["meet_at_limits", "solutions_at_limits"]


_FLIP = 1.0
"""A joint that moves by more than this in a step may be flipping [rad or m]."""
_SAVED = 0.5
"""Joint motion that leaving the targets has to save [rad or m]."""


def meet_at_limits(
    problem: WaypointProblem, targets: Targets, candidates: IkCandidates, q: Array, cost: float
) -> tuple[Array, float]:
    """Return a sequence that stays at limits within the tolerance, where that saves a flip.

    Args:
        problem: The targets.
        targets: The same as arrays.
        candidates: Solutions of each.
        q: The shortest sequence of these, shape (n, dof) [rad or m].
        cost: What it costs [rad or m].

    Returns:
        A sequence and its cost: those given where there is no flip, or none that this saves.

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    arm = problem.solver.arm
    rows = q if problem.start_free else np.vstack([problem.q_start, q])
    if len(rows) < 2 or np.abs(np.diff(rows, axis=0)).max() <= _FLIP:
        return q, cost
    if any(arm.dof > fixed_rows(target.freedom, target.oriented) for target in problem.targets):
        # An arm with a motion of its own leaves a limit without a flip.
        return q, cost
    at_limits = solutions_at_limits(problem, targets)
    if not any(len(found) for found in at_limits):
        return q, cost
    joined = _joined(candidates, at_limits)
    for length, other in shortened_sequences(
        arm, targets, joined, problem.q_start, problem.start_free, problem.cost, problem.clock
    ):
        problem.clock.check()
        if length < cost - _SAVED:
            exact = _exact_where_free(arm, candidates, other, 2.0 * _hair(problem))
            if _met(problem, targets, exact) and problem.first_contact(exact) is None:
                q, cost = exact, length
    return q, cost


def solutions_at_limits(problem: WaypointProblem, targets: Targets) -> list[Array]:
    """Return, of each target, solutions past limits brought to them, within the tolerance.

    Args:
        problem: The targets.
        targets: The same as arrays.
    """
    arm, hair = problem.solver.arm, _hair(problem)
    wider = replace(arm, lower=arm.lower - hair, upper=arm.upper + hair)
    with problem.clock.stage("ik"):
        past = ik_candidates(
            wider, targets, problem.q_start, problem.clock, seed=problem.solver.seed
        )
    return [
        _clipped(problem, wider, targets, k, past.q[k, : past.counts[k]])
        for k in range(len(problem.targets))
    ]


def _hair(problem: WaypointProblem) -> Array:
    """How far past its limit a solution of each joint is looked for, shape (dof,)."""
    tolerance, chain = problem.tolerance, problem.solver.arm.chain
    allowed = np.where(chain.prismatic, tolerance.position, tolerance.orientation)
    moved = np.abs(chain.coupling)
    # One value may move several serial joints: the one that it moves farthest counts.
    share = np.divide(allowed[:, None], moved, out=np.full(moved.shape, np.inf), where=moved > 0.0)
    hair = share.min(axis=0)
    return np.where(np.isfinite(hair), hair, 0.0)


def _clipped(problem: WaypointProblem, wider: Arm, targets: Targets, k: int, rows: Array) -> Array:
    """Solutions of target k past limits, brought to them, that are within the tolerance."""
    arm = problem.solver.arm
    rows = with_equivalents(wider, rows)
    past = ((rows < arm.lower) | (rows > arm.upper)).any(axis=1)
    rows = np.clip(rows[past], arm.lower, arm.upper)
    if len(rows) and problem.contact is not None:
        rows = rows[problem.contact.free(rows, problem.segment(k))]
    same = np.full(len(rows), k)
    return rows[_within(problem, targets, same, rows)]


def _within(problem: WaypointProblem, targets: Targets, k: Indices, rows: Array) -> Flags:
    """Whether each configuration meets its target within the tolerance, shape (m,)."""
    if len(rows) == 0:
        return np.zeros(0, dtype=bool)
    mine = Targets(
        targets.R[k], targets.p[k], targets.oriented[k], targets.weight[k], targets.freedom
    )
    errors, _ = linearised_errors(problem.solver.arm.chain, mine, np.ascontiguousarray(rows))
    distance = np.linalg.norm(errors[:, :3], axis=1)
    angle = np.linalg.norm(errors[:, 3:], axis=1) / np.maximum(mine.weight, 1e-12)
    tolerance = problem.tolerance
    angle = np.where(mine.oriented, angle, 0.0)
    return np.asarray((distance <= tolerance.position) & (angle <= tolerance.orientation))


def _met(problem: WaypointProblem, targets: Targets, q: Array) -> bool:
    return bool(_within(problem, targets, np.arange(len(q)), q).all())


def _joined(candidates: IkCandidates, more: list[Array]) -> IkCandidates:
    """Candidates with more of each target behind them."""
    counts = candidates.counts + np.array([len(rows) for rows in more])
    n, _, dof = candidates.q.shape
    q = np.zeros((n, int(counts.max()), dof))
    for k, rows in enumerate(more):
        own = candidates.counts[k]
        q[k, :own] = candidates.q[k, :own]
        q[k, own : counts[k]] = rows
    return IkCandidates(q, counts, candidates.evaluations.copy())


def _exact_where_free(arm: Arm, candidates: IkCandidates, q: Array, near: Array) -> Array:
    """Configurations with those replaced that have an exact solution next to them."""
    exact = q.copy()
    for k, row in enumerate(q):
        copies = with_equivalents(arm, candidates.q[k, : candidates.counts[k]])
        off = (np.abs(copies - row) / near).max(axis=1)
        best = int(np.argmin(off))
        if off[best] <= 1.0:
            exact[k] = copies[best]
    return exact
