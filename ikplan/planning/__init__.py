"""The choice of one configuration per waypoint."""

from ikplan.planning.choose import choose
from ikplan.planning.clock import Clock
from ikplan.planning.problem import Chosen, WaypointProblem

__all__ = ["Chosen", "Clock", "WaypointProblem", "choose"]
