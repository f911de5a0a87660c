"""A second reading of the request: the tool path in plain numpy, from the words of the document.

It shares nothing with the path that the planner follows: other formulas, other code. The words:
``docs/paths.md``.
"""

from ikplan.certificate.requested.motion import RequestedMotion, RequestedWaypoint, ToolLeg
from ikplan.certificate.requested.order import broken_order
from ikplan.certificate.requested.path import RequestedPath
from ikplan.certificate.requested.reading import read_motion

__all__ = [
    "RequestedMotion",
    "RequestedPath",
    "RequestedWaypoint",
    "ToolLeg",
    "broken_order",
    "read_motion",
]
