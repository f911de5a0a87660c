"""The choice of one configuration per waypoint."""

from ikplan.planning.clock import Clock
from ikplan.planning.greedy import choose_greedily
from ikplan.planning.problem import Chosen, WaypointProblem

__all__ = ["Chosen", "Clock", "WaypointProblem", "choose_greedily"]
