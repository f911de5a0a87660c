"""Which way the configurations of a path are chosen."""

from __future__ import annotations

from collections.abc import Sequence

from ikplan.arrays import Array
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.errors import InvalidRequest
from ikplan.path import JointLeg, Leg
from ikplan.planning.waypoints.clear_waypoints import select_clear, select_clear_greedily
from ikplan.planning.waypoints.greedy import select_greedily
from ikplan.planning.waypoints.least_motion import select_least_motion
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["check_objective", "select_configurations"]


def check_objective(options: IkOptions, legs: Sequence[Leg]) -> None:
    """Refuse clearance as the objective of a path on which it would not act throughout.

    Args:
        options: How joint solutions are looked for.
        legs: The legs of the path.

    Raises:
        InvalidRequest: Clearance is asked for, and the path has a tool path or a move.
    """
    if options.objective == "clearance" and not all(isinstance(leg, JointLeg) for leg in legs):
        raise InvalidRequest(
            "ik.objective: clearance chooses the configurations of waypoints that joint motions "
            "lead to; this path has a tool path or a move",
            field="ik.objective",
            allowed=["motion", "time"],
        )


def select_configurations(problem: WaypointProblem, options: IkOptions) -> Array:
    """Choose one configuration per waypoint.

    Seeds that are not to be refined leave nothing to choose from: they are taken as they come,
    waypoint by waypoint.

    Args:
        problem: The targets.
        options: How joint solutions are looked for.

    Returns:
        One configuration per waypoint, shape (n, dof) [rad or m].

    Raises:
        Unreachable: A waypoint has no solution.
        BudgetExceeded: The time budget ran out.
    """
    if options.objective == "clearance" and options.refine:
        if options.elongation == "greedy":
            return select_clear_greedily(problem)
        return select_clear(problem)
    if options.elongation == "greedy" or not options.refine:
        return select_greedily(problem)
    return select_least_motion(problem)
