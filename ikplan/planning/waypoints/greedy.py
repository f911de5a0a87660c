"""Waypoint by waypoint: at each, the solution nearest to the one before."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.waypoints.free_solutions import free_solutions
from ikplan.planning.waypoints.waypoint_ik import solve_waypoint
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["select_greedily"]


def select_greedily(problem: WaypointProblem) -> Array:
    """Choose the nearest solution found at each waypoint, in order.

    Args:
        problem: The targets.

    Returns:
        One configuration per waypoint, shape (n, dof) [rad or m].

    Raises:
        Unreachable: A waypoint has no solution; names every such waypoint.
        InCollision: All solutions of a waypoint found are in contact.
        BudgetExceeded: The time budget ran out; carries the waypoints solved.
    """
    q = np.empty((len(problem.targets), problem.robot.dof))
    q_before = problem.q_start
    with problem.clock.stage("ik"):
        for k in range(len(problem.targets)):
            problem.clock.check({"waypoints_solved": k, "q": q[:k].tolist()})
            problem.clock.report(problem.first_row + k)
            q_near = q_before
            q_before = solve_waypoint(problem, k, q_near)
            contact = problem.contact
            if contact is not None and not contact.free(q_before[None], problem.segment(k))[0]:
                q_before = free_solutions(problem, k, q_near)[0]
            q[k] = q_before
    return q
