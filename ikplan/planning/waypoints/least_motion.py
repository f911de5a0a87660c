"""The whole path at once: the sequence of configurations of least joint motion."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.errors import InCollision
from ikplan.planning.ladder.free_candidates import shortest_free_sequence
from ikplan.planning.ladder.ik_candidates import IkCandidates, Targets
from ikplan.planning.ladder.shortest_sequences import ik_candidates, shortened_sequences
from ikplan.planning.tracking.start_copies import StartCopies
from ikplan.planning.waypoints.free_solutions import free_solutions
from ikplan.planning.waypoints.in_collision import motion_in_collision
from ikplan.planning.waypoints.past_limits import meet_at_limits
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.waypoints.waypoint_ik import solve_waypoint
from ikplan.planning.waypoints.waypoint_problem import (
    WaypointProblem,
)

__all__ = ["no_way", "sampled_candidates", "select_least_motion"]


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
        InCollision: All solutions of a waypoint found, or motions to it, are in contact.
        BudgetExceeded: The time budget ran out.
    """
    arm = problem.solver.arm
    targets = stack_targets(problem.targets)
    candidates = sampled_candidates(problem, targets)
    best, best_length = candidates.q[:, 0], np.inf
    # One waypoint from a free start is met without motion by every solution: the nearest is chosen.
    choose_begin = problem.start_free and len(problem.targets) > 1
    for length, q in shortened_sequences(
        arm, targets, candidates, problem.q_start, choose_begin, problem.cost, problem.clock
    ):
        if length < best_length and problem.first_contact(q) is None:
            best, best_length = q, length
        problem.clock.check({"q": best.tolist()})
    if choose_begin == problem.start_free:
        best, best_length = meet_at_limits(problem, targets, candidates, best, best_length)
    if problem.contact is not None and best_length == np.inf:
        best = _around(problem, candidates)
    if problem.start_free:
        # Full turns of the whole motion leave it as long as it is.
        best, _ = StartCopies(problem.q_start, False, problem.posture).fitting(arm, best)
    return best


def sampled_candidates(problem: WaypointProblem, targets: Targets) -> IkCandidates:
    """Return solutions of each target, one at least, none of them in contact.

    Args:
        problem: The targets.
        targets: The same as arrays.

    Raises:
        Unreachable: A waypoint has no solution; names every such waypoint.
        InCollision: All solutions of a waypoint found are in contact.
        BudgetExceeded: The time budget ran out.
    """
    arm = problem.solver.arm
    lower, upper = arm.search_bounds(problem.q_start)
    with problem.clock.stage("ik"):
        seeds = _metaheuristic_seeds(problem, lower, upper)
        candidates = ik_candidates(
            arm, targets, problem.q_start, problem.clock, seeds, problem.solver.seed
        )
        problem.clock.check()
        _rescue(problem, candidates)
        if problem.contact is not None:
            _keep_free(problem, candidates)
    return candidates


def _keep_free(problem: WaypointProblem, candidates: IkCandidates) -> None:
    """Drop candidates in contact, in place; where none is left, more are drawn.

    Raises:
        InCollision: All candidates found of a waypoint are in contact.
    """
    assert problem.contact is not None
    cap = candidates.q.shape[1]
    all_free = _free(problem, candidates)
    for k in range(len(problem.targets)):
        kept = candidates.q[k, : candidates.counts[k]][all_free[k]]
        if len(kept) == 0:
            problem.clock.check()
            near = candidates.q[k - 1, 0] if k > 0 else problem.q_start
            kept = free_solutions(problem, k, near)[:cap]
        candidates.q[k, : len(kept)] = kept
        candidates.counts[k] = len(kept)


def _free(problem: WaypointProblem, candidates: IkCandidates) -> list[Flags]:
    """Which candidates of each waypoint are free of contact."""
    contact, counts = problem.contact, candidates.counts.tolist()
    assert contact is not None
    rows = [candidates.q[k, :count] for k, count in enumerate(counts)]
    if contact.changes_by_segment:
        return [contact.free(q, problem.segment(k)) for k, q in enumerate(rows)]
    return np.split(contact.free(np.concatenate(rows), None), np.cumsum(counts[:-1]))


def _around(problem: WaypointProblem, candidates: IkCandidates) -> Array:
    """The shortest sequence of candidates between which the straight motions are free.

    Raises:
        InCollision: None was found.
    """
    contact = problem.contact
    assert contact is not None

    def price(k: int, q_before: Array, q: Array) -> float:
        problem.clock.check()
        free = contact.first_contact(np.vstack([q_before, q]), problem.segment(k)) is None
        return 0.0 if free else np.inf

    found = shortest_free_sequence(
        candidates, problem.q_start, problem.start_free, problem.cost, price
    )
    if found is None:
        raise no_way(problem, candidates)
    return found


def no_way(problem: WaypointProblem, candidates: IkCandidates) -> InCollision:
    """Return the verdict where no sequence of candidates has free motions between them."""
    assert problem.contact is not None
    straight = problem.first_contact(candidates.q[:, 0])
    assert straight is not None
    row = problem.first_row + max(straight.step - (not problem.start_free), 0)
    return motion_in_collision(
        problem.contact, straight, row, f"the joint motion to waypoint {row}", problem.segment(0)
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
