"""Which way the configurations of a path are chosen."""

from __future__ import annotations

from ikplan.documents.plan_request import IkOptions
from ikplan.planning.waypoints.greedy import choose_greedily
from ikplan.planning.waypoints.least_motion import choose_least_motion
from ikplan.planning.waypoints.waypoint_problem import Chosen, WaypointProblem

__all__ = ["choose"]


def choose(problem: WaypointProblem, options: IkOptions) -> Chosen:
    """Choose one configuration per waypoint.

    Seeds that are not to be refined leave nothing to choose from: they are taken as they come,
    waypoint by waypoint.

    Args:
        problem: The targets.
        options: How joint solutions are looked for.

    Returns:
        One configuration per waypoint.

    Raises:
        Unreachable: A waypoint has no solution.
        BudgetExceeded: The time budget ran out.
    """
    if options.elongation == "greedy" or not options.refine:
        return choose_greedily(problem)
    return choose_least_motion(problem)
