"""Points from files: poses or joint values in the dialects that people have, as requests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan._lazy import on_first_use

if TYPE_CHECKING:
    from ikplan.points.choices import Choices, frame_of
    from ikplan.points.columns import JointName
    from ikplan.points.names import INTERPOLATIONS, TOOL_AXES
    from ikplan.points.note import Note
    from ikplan.points.points import Points, Speed
    from ikplan.points.reading import Reading, read_points, read_waypoints
    from ikplan.points.request import request_of
    from ikplan.points.table import has_no_header
else:
    __getattr__ = on_first_use(
        __name__,
        {
            "INTERPOLATIONS": "names",
            "Choices": "choices",
            "frame_of": "choices",
            "JointName": "columns",
            "Note": "note",
            "Points": "points",
            "Speed": "points",
            "TOOL_AXES": "names",
            "Reading": "reading",
            "read_points": "reading",
            "read_waypoints": "reading",
            "request_of": "request",
            "has_no_header": "table",
        },
    )

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
