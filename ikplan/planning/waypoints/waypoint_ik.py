"""One waypoint: a solution, or a configuration within tolerance, or the verdict."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import Unreachable
from ikplan.ik.solve import NoSolution, target_as_data
from ikplan.planning.waypoints.unreachable import met_within, unreachable_path
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["solve_waypoint"]


def solve_waypoint(problem: WaypointProblem, k: int, q_before: Array) -> Array:
    """Return a configuration of waypoint k, near to ``q_before``.

    Args:
        problem: The targets.
        k: Index of the waypoint.
        q_before: Configuration to be near to, shape (dof,) [rad or m].

    Raises:
        Unreachable: None is within tolerance; names every waypoint from k on that has none.
    """
    target = problem.targets[k]
    tolerance = problem.tolerance
    try:
        solved = problem.solver.solve(target, q_before)
    except NoSolution as verdict:
        met = met_within(problem.solver, target, verdict, q_before, tolerance)
        problem.clock.count(verdict.evaluations)
        if met is not None:
            return met
        raise unreachable_path(problem, k, verdict.closest, q_before) from verdict
    problem.clock.count(solved.evaluations)
    distance, angle = float(solved.position_error[0]), float(solved.orientation_error[0])
    if distance > tolerance.position or angle > tolerance.orientation:
        # Only an unrefined solver ends here: its best is what it is.
        raise Unreachable(
            f"waypoint {problem.first_row + k}: {problem.solver.method} without refinement ends "
            f"{distance * 1e3:.3g} mm and {angle:.3g} rad away, outside the tolerance of "
            f"{tolerance.position * 1e3:.3g} mm and {tolerance.orientation:.3g} rad; "
            "set ik.refine, or a larger budget or tolerance",
            waypoint=problem.first_row + k,
            position_error=distance,
            orientation_error=angle if target.oriented else None,
            q=[float(v) for v in solved.q[0]],
            reason="the solver was not refined and did not converge to the tolerance",
            target=target_as_data(target),
        )
    q: Array = solved.q[0]
    robot = problem.robot
    outside = np.flatnonzero((q < robot.lower) | (q > robot.upper))
    if len(outside):
        # The decoupled search of the paper ignores the limits of the wrist.
        names = ", ".join(robot.joint_names[j] for j in outside)
        raise Unreachable(
            f"waypoint {problem.first_row + k}: {problem.solver.method} without refinement ends "
            f"outside the limits of {names}; set ik.refine or params.wrist_limits",
            waypoint=problem.first_row + k,
            position_error=distance,
            orientation_error=angle if target.oriented else None,
            q=[float(v) for v in q],
            reason="the solver was not refined and left the position limits",
            limits=[robot.joint_names[j] for j in outside],
            target=target_as_data(target),
        )
    return q
