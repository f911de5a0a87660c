"""Which way the configurations of a path are chosen."""

from __future__ import annotations

from ikplan.arrays import Array
from ikplan.documents.plan_request import IkOptions
from ikplan.planning.waypoints.greedy import select_greedily
from ikplan.planning.waypoints.least_motion import select_least_motion
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["select_configurations"]


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
    if options.elongation == "greedy" or not options.refine:
        return select_greedily(problem)
    return select_least_motion(problem)
