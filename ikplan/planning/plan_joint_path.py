"""From the path of a request to the configurations that a joint path passes."""

from __future__ import annotations

from dataclasses import replace

from ikplan.errors import Disconnected, InCollision, Unreachable
from ikplan.path import JointLeg, Leg, MoveLeg, Pose, ToolLeg, legs_of
from ikplan.planning.joint_planner import JointPathPlanner
from ikplan.planning.joint_route import JointPathProblem, JointRoute
from ikplan.planning.tool_pose import tool_pose
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.waypoints.select import check_objective

__all__ = ["plan_joint_path"]


def plan_joint_path(problem: JointPathProblem) -> JointRoute:
    """Plan the configurations that a joint path passes.

    Args:
        problem: The path.

    Returns:
        The configurations; a joint path through them meets every waypoint and tracks every tool
        path.

    Raises:
        InvalidRequest: The path makes no sense.
        Unreachable: A waypoint, or a place on a tool path, has no solution.
        Disconnected: No continuous motion follows a tool path.
        InCollision: The start, or all that was found for a waypoint or a path, is in contact, or
            no way was found for a move.
        TrackingFailed: The same, where ``problem.explain`` is false.
        BudgetExceeded: The time budget ran out.
    """
    planner = JointPathPlanner(problem)
    start = None
    if not problem.start_free:
        planner.check_start_free()
        start = Pose(*tool_pose(problem, problem.q_start))
    rules = problem.order, problem.stops, problem.found
    legs = legs_of(problem.path, start, planner.fk, problem.rounding, *rules)
    check_objective(problem.options, legs)
    try:
        return _planned(planner, legs)
    except (Unreachable, Disconnected, InCollision, TrackingFailed):
        rounded = any(isinstance(leg, ToolLeg) and leg.path.taken > 0.0 for leg in legs)
        if not rounded or problem.rounding == "smooth":
            raise
    # The path itself may be passed where its rounded corners are not, and is what was asked for.
    problem = replace(problem, rounding="none")
    planner = JointPathPlanner(problem)
    return _planned(planner, legs_of(problem.path, start, planner.fk, "none", *rules))


def _planned(planner: JointPathPlanner, legs: list[Leg]) -> JointRoute:
    problem = planner.problem
    problem.clock.set_total(sum(map(_waypoint_count, legs)))
    for leg, after in zip(legs, [*legs[1:], None], strict=True):
        if isinstance(leg, JointLeg):
            planner.joint_leg(leg, after)
        elif isinstance(leg, MoveLeg):
            planner.move_leg(leg, after)
        else:
            planner.tool_leg(leg, last=after is None)
        problem.clock.report(len(planner.waypoints))
    return planner.route()


def _waypoint_count(leg: Leg) -> int:
    if isinstance(leg, MoveLeg):
        return 1
    return len(leg.waypoints) if isinstance(leg, JointLeg) else len(leg.path.waypoints)
