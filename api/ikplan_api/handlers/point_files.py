"""Files of points over HTTP: CSV or G-code in the body, further options in the query."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastapi import Request

from ikplan.errors import InvalidRequest, near_names
from ikplan.points import INTERPOLATIONS, TOOL_AXES, Note
from ikplan.points.units import ANGLES, LENGTHS
from ikplan.robots import is_upload_id
from ikplan_api.http.body import media_type_of
from ikplan_api.http.disconnect import while_connected
from ikplan_api.robots.uploads import stored_robot
from ikplan_api.workers.headed import headed, split_head
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.point_file import GCODE, MEDIA_TYPE

__all__ = [
    "FILES",
    "NOTES",
    "PARAMETERS",
    "file_body",
    "is_file",
    "read_points_request",
    "remember_notes",
    "with_notes",
]

FILES = ("text/csv", GCODE)
"""Media types of files of points."""
NOTES = "ikplan-notes"
"""Response header with notes on how a file was read."""
_LONGEST_NOTES = 4000

_NUMBERS = "Numbers separated by commas: x,y,z [m], or with a rotation vector rx,ry,rz [rad], or "
_NUMBERS += "with a unit quaternion x,y,z,w."
PARAMETERS: dict[str, tuple[str, dict[str, Any]]] = {
    "robot": ("Name of the robot; required.", {"type": "string", "minLength": 1}),
    "units": (
        "Unit of lengths in the file; default: from its header, else guessed.",
        {"enum": list(LENGTHS)},
    ),
    "angles": (
        "Unit of angles in the file; default: from its header or the convention, else guessed.",
        {"enum": list(ANGLES)},
    ),
    "columns": (
        "Column names in order, for a file without a header, such as x,y,z,qx,qy,qz,qw; use - to "
        "skip a column.",
        {"type": "string", "minLength": 1},
    ),
    "free_axis": (
        "Tool axis about which the tool may rotate; columns i, j, k give its direction.",
        {"enum": list(TOOL_AXES)},
    ),
    "interpolation": ("Interpolation between the points.", {"enum": list(INTERPOLATIONS)}),
    "approach": ("Motion to the first point.", {"enum": ["path", "joint"]}),
    "start": (
        "Joint values at the start, separated by commas [rad or m], or `free`; default: home.",
        {"type": "string", "minLength": 1},
    ),
    "frame": (f"Frame of the points, in the base. {_NUMBERS}", {"type": "string"}),
    "base_frame": (
        "Frame of the points: a link fixed to the robot's base, or `controller` for the base frame "
        "of the teach pendant.",
        {"type": "string", "minLength": 1},
    ),
    "tool": (f"Tool frame, in the tip frame. {_NUMBERS}", {"type": "string"}),
    "scene": ("Id of an uploaded scene.", {"type": "string", "minLength": 1}),
    "tool_speed": ("Limit of the tool speed [m/s].", {"type": "number", "exclusiveMinimum": 0}),
    "rate_hz": ("Samples per second [Hz].", {"type": "number", "minimum": 1}),
}
"""Query parameters of a request with a file, each with its description and schema."""


def file_body() -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Describe bodies in CSV and G-code, and their query parameters."""
    example = "x [mm],y [mm],z [mm],rx,ry,rz\n400,-100,300,3.1416,0,0\n400,100,300,3.1416,0,0\n"
    parameters = [
        {
            "name": name,
            "in": "query",
            "description": f"With CSV or G-code: {words}",
            "schema": schema,
        }
        for name, (words, schema) in PARAMETERS.items()
    ]
    examples = dict(zip(FILES, (example, "G21 G90\nG0 X0 Y0 Z5\nG1 X50 F1200\n"), strict=True))
    bodies = {each: {"schema": {"type": "string"}, "example": examples[each]} for each in FILES}
    return bodies, parameters


def with_notes(
    answers: Mapping[int | str, dict[str, Any]],
) -> dict[int | str, dict[str, Any]]:
    """Add the header with notes on how a file was read to successful responses."""
    header = {
        "description": "Notes on how a file of points was read; absent without a file.",
        "schema": {"type": "string"},
    }
    return {
        status: {**answer, "headers": {**answer.get("headers", {}), "Ikplan-Notes": header}}
        if status in (200, 202)
        else answer
        for status, answer in answers.items()
    }


def is_file(request: Request) -> bool:
    """Whether the body of a request is a file of points.

    Raises:
        InvalidRequest: The body is JSON, but the query has parameters for files.
    """
    if media_type_of(request) in FILES:
        return True
    misplaced = next((name for name in request.query_params if name in PARAMETERS), None)
    if misplaced is not None:
        raise InvalidRequest(
            f"{misplaced}: query parameters are for files ({' or '.join(FILES)}); in a JSON "
            "request, put this into the document",
            field=misplaced,
        )
    return False


async def read_points_request(request: Request, body: bytes) -> tuple[bytes, list[Note]]:
    """Return the request document for a file of points, and notes on how it was read.

    Args:
        request: The HTTP request with its query.
        body: The file.

    Raises:
        InvalidRequest: The file or the query is invalid; names line and column or the parameter.
        RobotNotFound: No robot has that name.
        ServiceUnavailable: The queue is full.
    """
    query = _query(request)
    name = query["robot"]
    robot = (await stored_robot(request, name)).document if is_upload_id(name) else None
    planner: Planner = request.app.state.planner
    head = {**query, MEDIA_TYPE: media_type_of(request)}
    work = planner.run("read-points", headed(head, body), robot=robot)
    told, document = split_head((await while_connected(request, work)).document)
    return document, [Note(**note) for note in told]


def remember_notes(request: Request, notes: list[Note]) -> None:
    """Store the notes on a request's file for the header of its response."""
    text = "; ".join(note.text for note in notes).encode("ascii", "backslashreplace").decode()
    shown = "".join(c if c.isprintable() else "?" for c in text)[:_LONGEST_NOTES]
    request.scope.setdefault("state", {})["notes"] = shown


def _query(request: Request) -> dict[str, str]:
    """Return the query after a check of its names."""
    query: dict[str, str] = {}
    for name, value in request.query_params.multi_items():
        if name not in PARAMETERS:
            near = near_names(name, PARAMETERS)
            hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(PARAMETERS)}"
            raise InvalidRequest(
                f"{name[:200]}: unknown parameter; {hint}",
                field=name[:200],
                allowed=list(PARAMETERS),
            )
        if name in query:
            raise InvalidRequest(f"{name}: given twice", field=name)
        query[name] = value
    if not query.get("robot"):
        raise InvalidRequest("robot: this parameter is required with a file", field="robot")
    return query
