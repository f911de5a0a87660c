"""The verdict on a path with waypoints out of reach: all of them, not only the first."""

from __future__ import annotations

from typing import Any

from ikplan.arrays import Array
from ikplan.documents.poses import Tolerance
from ikplan.errors import Unreachable
from ikplan.ik.closest_approach import ClosestApproach, within
from ikplan.ik.solve import NoSolution, PoseSolver, surest_solver, target_as_data, unreachable
from ikplan.kinematics.target import Target
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["met_within", "unreachable_path"]

_MOST_EXAMINED = 200
"""Waypoints after the first unreachable one that are examined as well."""


def unreachable_path(
    problem: WaypointProblem, first: int, closest: ClosestApproach, q_before: Array
) -> Unreachable:
    """Return the error of a path whose waypoint ``first`` is out of reach.

    The waypoints after it are examined too, so that a user sees in one answer how much of the path
    is out of reach.
    """
    count = len(problem.targets)
    closest_by_waypoint = {first: closest}
    most = _MOST_EXAMINED if problem.explain else 0
    examined = range(first + 1, min(count, first + 1 + most))
    for k in examined:
        problem.clock.check({"waypoints_solved": first})
        problem.clock.report(problem.first_row + k)
        solver = surest_solver(problem.solver, problem.targets[k])
        try:
            q_before = solver.solve(problem.targets[k], q_before).q[0]
        except NoSolution as verdict:
            target = problem.targets[k]
            if met_within(problem.solver, target, verdict, q_before, problem.tolerance) is None:
                closest_by_waypoint[k] = verdict.closest
    unexamined = count - 1 - examined[-1] if examined else 0
    row = problem.first_row
    subject = f"waypoint {row + first} of {row + count} (counted from 0)"
    if len(closest_by_waypoint) > 1:
        others = ", ".join(str(row + k) for k in list(closest_by_waypoint)[1:12]) + (
            ", ..." if len(closest_by_waypoint) > 12 else ""
        )
        subject += f", as {'are' if len(closest_by_waypoint) > 2 else 'is'} {others}"
        subject += f" ({unexamined} more not examined)," if unexamined else ","
    error = unreachable(problem.robot, closest, row + first, subject, problem.targets[first])
    error.waypoints = [_row(row + k, m, problem.targets[k]) for k, m in closest_by_waypoint.items()]
    return error


def met_within(
    solver: PoseSolver, target: Target, verdict: NoSolution, q_near: Array, tolerance: Tolerance
) -> Array | None:
    """Return a configuration within the tolerance of a target without a solution, or None.

    Args:
        solver: Found none.
        target: The target.
        verdict: The verdict of the solver; what is spent here is added to its evaluations.
        q_near: Configuration to be near to, shape (dof,) [rad or m].
        tolerance: How far off the target the tool may be.
    """
    bounds = tolerance.position, tolerance.orientation
    met, spent = within(solver.arm, target, verdict.closest, q_near, *bounds)
    verdict.evaluations += spent
    return None if met is None else met.q


def _row(k: int, closest: ClosestApproach, target: Target) -> dict[str, Any]:
    return {
        "waypoint": k,
        "position_error": closest.position_error,
        "orientation_error": closest.orientation_error,
        "reason": closest.reason,
        "target": target_as_data(target),
    }
