"""From a path of a request to the configurations of a joint path."""

from ikplan.planning.joint_route import JointPathProblem, JointRoute, RouteWaypoint
from ikplan.planning.plan_joint_path import plan_joint_path
from ikplan.planning.waypoints.select import select_configurations
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.time_budget import Progress, TimeBudget

__all__ = [
    "JointPathProblem",
    "JointRoute",
    "Progress",
    "RouteWaypoint",
    "TimeBudget",
    "WaypointProblem",
    "plan_joint_path",
    "select_configurations",
]
