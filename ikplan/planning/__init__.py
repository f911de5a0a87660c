"""From a tool path to the knots of a joint path."""

from ikplan.planning.choose import choose
from ikplan.planning.clock import Clock, Progress
from ikplan.planning.lay import lay_route
from ikplan.planning.problem import Chosen, WaypointProblem
from ikplan.planning.repair import find_repairs
from ikplan.planning.route import Route, RouteProblem, Span, Wanted

__all__ = [
    "Chosen",
    "Clock",
    "Progress",
    "Route",
    "RouteProblem",
    "Span",
    "Wanted",
    "WaypointProblem",
    "choose",
    "find_repairs",
    "lay_route",
]
