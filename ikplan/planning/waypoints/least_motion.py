"""The whole path at once: the sequence of configurations of least joint motion."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.kinematics.target import Target
from ikplan.planning.ladder.ik_candidates import IkCandidates, Targets
from ikplan.planning.ladder.shortest_sequences import ik_candidates, shortened_sequences
from ikplan.planning.waypoints.waypoint_ik import solve_waypoint
from ikplan.planning.waypoints.waypoint_problem import (
    WaypointProblem,
)

__all__ = ["select_least_motion", "stack_targets"]


def select_least_motion(problem: WaypointProblem) -> Array:
    """Choose the configurations that move the joints least over the whole path.

    Candidates of each waypoint, the shortest paths over their ladder that really differ, each of
    them shortened; the shortest of these is taken.

    Args:
        problem: The targets.

    Returns:
        One configuration per waypoint, shape (n, dof) [rad or m].

    Raises:
        Unreachable: A waypoint has no solution; names every such waypoint.
        BudgetExceeded: The time budget ran out.
    """
    arm = problem.solver.arm
    lower, upper = arm.search_bounds(problem.q_start)
    targets = stack_targets(problem.targets)
    with problem.clock.stage("ik"):
        seeds = _metaheuristic_seeds(problem, lower, upper)
        candidates = ik_candidates(
            arm, targets, problem.q_start, problem.clock, seeds, problem.solver.seed
        )
        problem.clock.check()
        _rescue(problem, candidates)
    best, best_length = candidates.q[:, 0], np.inf
    for length, q in shortened_sequences(
        arm, targets, candidates, problem.q_start, problem.start_free, problem.clock
    ):
        if length < best_length:
            best, best_length = q, length
        problem.clock.check({"q": best.tolist()})
    return best


def stack_targets(targets: list[Target]) -> Targets:
    """Return targets, which share their freedom, as arrays."""
    return Targets(
        np.array([t.R for t in targets]),
        np.array([t.p for t in targets]),
        np.array([t.oriented for t in targets]),
        np.array([t.weight for t in targets]),
        targets[0].freedom,
    )


def _metaheuristic_seeds(problem: WaypointProblem, lower: Array, upper: Array) -> Array:
    """The best of the last populations of the method, shape (n, k, dof).

    Each search starts from the best of the one before, as the papers track a path.
    """
    searcher = problem.solver.searcher
    if searcher is None:
        return np.empty((len(problem.targets), 0, problem.robot.dof))
    rows, q_s = [], problem.q_start
    for k, target in enumerate(problem.targets):
        problem.clock.check()
        problem.clock.report(problem.first_row + k)
        seeds, spent = searcher.seeds(target, q_s, lower, upper)
        rows.append(seeds)
        problem.clock.count(spent)
        q_s = np.clip(seeds[0], lower, upper)
    return np.array(rows)


def _rescue(problem: WaypointProblem, candidates: IkCandidates) -> None:
    """Find a candidate for every waypoint without one, in place.

    Raises:
        Unreachable: There is none within tolerance.
    """
    for k in np.flatnonzero(candidates.counts == 0):
        problem.clock.check()
        q_near = candidates.q[k - 1, 0] if k > 0 else problem.q_start
        candidates.q[k, 0] = solve_waypoint(problem, int(k), q_near)
        candidates.counts[k] = 1
