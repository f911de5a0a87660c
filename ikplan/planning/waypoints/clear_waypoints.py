"""Configurations of the waypoints of a path that keep clear of bodies."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.ik.restarts import nearest_turns
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.tracking.start_copies import StartCopies
from ikplan.planning.waypoints.clear_solutions import clearest_solution, crowding_at
from ikplan.planning.waypoints.least_motion import free_sequence, sampled_candidates
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.waypoints.waypoint_ik import solve_waypoint
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["PRICE", "select_clear", "select_clear_greedily"]

PRICE = 10.0
"""Joint motion that a crowding of 1 at a waypoint is worth [rad or m]."""


def select_clear(problem: WaypointProblem) -> Array:
    """Choose the configurations of least joint motion and crowding over the whole path.

    The cost of a sequence is its joint motion and ``PRICE`` times the crowding of each of its
    configurations. It is not shortened after: that would take the clearance away again.

    Args:
        problem: The targets, and a check for contact.

    Returns:
        One configuration per waypoint, shape (n, dof) [rad or m].

    Raises:
        Unreachable: A waypoint has no solution; names every such waypoint.
        InCollision: All solutions of a waypoint found, or motions to it, are in contact.
        BudgetExceeded: The time budget ran out.
    """
    assert problem.contact is not None
    arm = problem.solver.arm
    candidates = sampled_candidates(problem, stack_targets(problem.targets))
    prices = [
        PRICE * crowding_at(problem.contact, candidates.q[k, :count], problem.segment(k))
        for k, count in enumerate(candidates.counts)
    ]
    best = free_sequence(problem, candidates, prices)
    turned = best.copy()
    for k in range(len(turned)):
        if k > 0 or not problem.start_free:
            q_before = turned[k - 1] if k > 0 else problem.q_start
            nearest_turns(arm.chain, turned[k], q_before, arm.lower, arm.upper)
    if _length(problem, turned) < _length(problem, best) and problem.first_contact(turned) is None:
        best = turned
    if problem.start_free:
        # Full turns of the whole motion leave it as long as it is.
        best, _ = StartCopies(problem.q_start, counted=False).fitting(arm, best)
    return best


def select_clear_greedily(problem: WaypointProblem) -> Array:
    """Choose at each waypoint, in order, the solution of least joint motion and crowding.

    Args:
        problem: The targets, and a check for contact.

    Returns:
        One configuration per waypoint, shape (n, dof) [rad or m].

    Raises:
        Unreachable: A waypoint has no solution.
        InCollision: All solutions of a waypoint found are in contact.
        BudgetExceeded: The time budget ran out; carries the waypoints solved.
    """
    q = np.empty((len(problem.targets), problem.robot.dof))
    q_before = problem.q_start
    with problem.clock.stage("ik"):
        for k in range(len(problem.targets)):
            problem.clock.check({"waypoints_solved": k, "q": q[:k].tolist()})
            problem.clock.report(problem.first_row + k)
            nearest = solve_waypoint(problem, k, q_before)
            q[k] = q_before = clearest_solution(problem, k, q_before, nearest, PRICE)
    return q


def _length(problem: WaypointProblem, q: Array) -> float:
    return float(joint_path_length(q, problem.q_start, problem.start_free))
