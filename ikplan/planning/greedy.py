"""Waypoint by waypoint: at each, the solution nearest to the one before."""

from __future__ import annotations

import numpy as np

from ikplan.errors import Unreachable
from ikplan.ik.solve import NoSolution
from ikplan.planning.problem import Array, Chosen, WaypointProblem
from ikplan.planning.verdict import unreachable_path

__all__ = ["choose_greedily"]


def choose_greedily(problem: WaypointProblem) -> Chosen:
    """Choose the nearest solution found at each waypoint, in order.

    Args:
        problem: The targets.

    Returns:
        One configuration per waypoint.

    Raises:
        Unreachable: A waypoint has no solution; names every such waypoint.
        BudgetExceeded: The time budget ran out; carries the waypoints solved.
    """
    q = np.empty((len(problem.targets), problem.robot.dof))
    q_before = problem.q_start
    evaluations = 0
    for k in range(len(problem.targets)):
        problem.clock.check({"waypoints_solved": k, "q": q[:k].tolist()})
        q_before, spent = _solve_one(problem, k, q_before)
        q[k] = q_before
        evaluations += spent
    return Chosen(q, evaluations)


def _solve_one(problem: WaypointProblem, k: int, q_before: Array) -> tuple[Array, int]:
    """Return the configuration of waypoint k and the evaluations spent on it."""
    target = problem.targets[k]
    tolerance = problem.tolerance
    try:
        solved = problem.solver.solve(target, q_before)
    except NoSolution as verdict:
        miss = verdict.miss
        angle = miss.orientation_error or 0.0
        if miss.position_error <= tolerance.position and angle <= tolerance.orientation:
            return miss.q, verdict.evaluations
        raise unreachable_path(problem, k, miss, q_before) from verdict
    distance, angle = float(solved.position_error[0]), float(solved.orientation_error[0])
    if distance > tolerance.position or angle > tolerance.orientation:
        # Only an unrefined solver ends here: its best is what it is.
        raise Unreachable(
            f"waypoint {k}: {problem.solver.method} without refinement ends "
            f"{distance * 1e3:.3g} mm and {angle:.3g} rad away, outside the tolerance of "
            f"{tolerance.position * 1e3:.3g} mm and {tolerance.orientation:.3g} rad; "
            "set ik.refine, or a larger budget or tolerance",
            waypoint=k,
            position_error=distance,
            orientation_error=angle if target.oriented else None,
            q=[float(v) for v in solved.q[0]],
            reason="the solver was not refined and did not converge to the tolerance",
        )
    return solved.q[0], solved.evaluations
