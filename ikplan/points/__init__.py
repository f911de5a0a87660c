"""Points from files: poses or joint values in the dialects that people have, as requests."""

from ikplan.points.choices import INTERPOLATIONS, Choices, frame_of
from ikplan.points.columns import JointName
from ikplan.points.note import Note
from ikplan.points.points import Points, Speed
from ikplan.points.poses import TOOL_AXES
from ikplan.points.reading import Reading, read_points, read_waypoints
from ikplan.points.request import request_of
from ikplan.points.table import has_no_header

__all__ = [
    "INTERPOLATIONS",
    "TOOL_AXES",
    "Choices",
    "JointName",
    "Note",
    "Points",
    "Reading",
    "Speed",
    "frame_of",
    "has_no_header",
    "read_points",
    "read_waypoints",
    "request_of",
]
