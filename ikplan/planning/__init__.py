"""From a tool path to the knots of a joint path."""

from ikplan.planning.joint_planner import plan_joint_path
from ikplan.planning.joint_route import JointPathProblem, Route, Span, WaypointKnot
from ikplan.planning.repairs import find_repairs
from ikplan.planning.waypoints.select import choose
from ikplan.planning.waypoints.waypoint_problem import Chosen, WaypointProblem
from ikplan.time_budget import Progress, TimeBudget

__all__ = [
    "Chosen",
    "JointPathProblem",
    "Progress",
    "Route",
    "Span",
    "TimeBudget",
    "WaypointKnot",
    "WaypointProblem",
    "choose",
    "find_repairs",
    "plan_joint_path",
]
