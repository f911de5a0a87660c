"""Configurations of the waypoints of a path that keep clear of bodies."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.ik.restarts import nearest_turns
from ikplan.planning.ladder.free_candidates import shortest_free_sequence
from ikplan.planning.ladder.ik_candidates import IkCandidates
from ikplan.planning.ladder.motion_cost import sequence_cost
from ikplan.planning.tracking.start_copies import StartCopies
from ikplan.planning.waypoints.clear_solutions import crowding_at
from ikplan.planning.waypoints.least_motion import no_way, sampled_candidates
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["PRICE", "select_clear", "select_clear_greedily"]

PRICE = 10.0
"""Joint motion that a crowding of 1 on the way to a waypoint is worth [rad or m]."""
_STEP = 0.2
"""Largest motion of a joint between two places of a motion that are looked at [rad or m]."""
_MOST = 24
"""Most places of a motion that are looked at."""


def select_clear(problem: WaypointProblem) -> Array:
    """Choose the configurations of least joint motion and crowding over the whole path.

    A motion costs its length and ``PRICE`` times the largest crowding on it; of a free start, the
    first configuration costs its own. The sequence is not shortened after: that would take the
    clearance away again.

    Args:
        problem: The targets, and a check for contact.

    Returns:
        One configuration per waypoint, shape (n, dof) [rad or m].

    Raises:
        Unreachable: A waypoint has no solution; names every such waypoint.
        InCollision: All solutions of a waypoint found, or motions to it, are in contact.
        BudgetExceeded: The time budget ran out.
    """
    arm = problem.solver.arm
    candidates = sampled_candidates(problem, stack_targets(problem.targets))
    best = _clearest_sequence(problem, candidates)
    turned = _with_nearest_turns(problem, best)
    if _cost(problem, turned) < _cost(problem, best):
        best = turned
    if problem.start_free:
        # Full turns of the whole motion leave it as long as it is.
        best, _ = StartCopies(problem.q_start, False, problem.posture).fitting(arm, best)
    return best


def select_clear_greedily(problem: WaypointProblem) -> Array:
    """Choose at each waypoint, in order, the solution of least joint motion and crowding.

    Args:
        problem: The targets, and a check for contact.

    Returns:
        One configuration per waypoint, shape (n, dof) [rad or m].

    Raises:
        Unreachable: A waypoint has no solution.
        InCollision: All solutions of a waypoint found, or motions to it, are in contact.
        BudgetExceeded: The time budget ran out.
    """
    q = np.empty((len(problem.targets), problem.robot.dof))
    before = problem
    for k, target in enumerate(problem.targets):
        problem.clock.report(problem.first_row + k)
        one = replace(
            before,
            targets=[target],
            first_row=problem.first_row + k,
            segments=problem.segments[k : k + 1],
        )
        q[k] = select_clear(one)[0]
        before = replace(problem, q_start=q[k], start_free=False)
    return q


def _clearest_sequence(problem: WaypointProblem, candidates: IkCandidates) -> Array:
    """The cheapest sequence of candidates between which the straight motions are free.

    Raises:
        InCollision: None was found.
    """
    contact, clock = problem.contact, problem.clock
    assert contact is not None

    def price(k: int, q_before: Array, q: Array) -> float:
        clock.check()
        crowded = _crowding_on(problem, k, q_before, q)
        return float(PRICE * (crowded.max() - max(crowded[0], crowded[-1])))

    def contact_only(k: int, q_before: Array, q: Array) -> float:
        clock.check()
        free = contact.first_contact(np.vstack([q_before, q]), problem.segment(k)) is None
        return 0.0 if free else math.inf

    charges = [PRICE * crowding_at(contact, problem.q_start[None], problem.segment(0))]
    for k, count in enumerate(candidates.counts):
        charges.append(PRICE * crowding_at(contact, candidates.q[k, :count], problem.segment(k)))
    for each in (price, contact_only):  # with prices the search may give up before its end
        found = shortest_free_sequence(
            candidates, problem.q_start, problem.start_free, problem.cost, each, charges
        )
        if found is not None:
            return found
    raise no_way(problem, candidates)


def _crowding_on(problem: WaypointProblem, k: int, q_before: Array, q: Array) -> Array:
    """Crowding along the straight motion to target k, both ends included; inf: it is in contact."""
    contact, segment = problem.contact, problem.segment(k)
    assert contact is not None
    if contact.first_contact(np.vstack([q_before, q]), segment) is not None:
        return np.array([0.0, math.inf, 0.0])
    places = min(math.ceil(float(np.abs(q - q_before).max()) / _STEP), _MOST)
    share = np.arange(places + 1)[:, None] / max(places, 1)
    return crowding_at(contact, q_before + share * (q - q_before), segment)


def _with_nearest_turns(problem: WaypointProblem, q: Array) -> Array:
    """The same sequence with each joint at its copy nearest to the configuration before."""
    arm, turned = problem.solver.arm, q.copy()
    for k in range(int(problem.start_free), len(q)):
        q_before = turned[k - 1] if k > 0 else problem.q_start
        nearest_turns(arm.chain, turned[k], q_before, arm.lower, arm.upper)
    return turned


def _cost(problem: WaypointProblem, q: Array) -> float:
    """Joint motion and price of a sequence."""
    total = float(sequence_cost(q, problem.q_start, problem.start_free, problem.cost))
    for k in range(int(problem.start_free), len(q)):
        q_before = q[k - 1] if k > 0 else problem.q_start
        total += PRICE * float(_crowding_on(problem, k, q_before, q[k]).max())
    return total
