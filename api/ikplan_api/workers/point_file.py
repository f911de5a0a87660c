"""The task that reads a file of points or of G-code, which takes 0.2 s for 10,000 points."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import InvalidRequest
from ikplan.gcode import gcode_request, read_toolpath
from ikplan.points import Choices, JointName, Reading, frame_of, read_points, request_of
from ikplan.robots import Robot, is_upload_id
from ikplan.robots.base_frames import frame_in_base
from ikplan_api.workers.headed import headed

__all__ = ["GCODE", "MEDIA_TYPE", "read_point_file"]

GCODE = "text/x-gcode"
"""Media type of G-code."""
MEDIA_TYPE = "media_type"
"""Name of the media type among the options of a file; no parameter of a query has it."""
_NOT_FOR_GCODE = ("angles", "columns", "interpolation")


def read_point_file(body: bytes, query: Mapping[str, str], robot: Robot) -> bytes:
    """Return the request document for a file of points, with the notes as its head.

    Args:
        body: The file.
        query: Options by name, of which ``robot`` and ``media_type`` are two.
        robot: The robot named there.

    Raises:
        InvalidRequest: The file or the query is invalid; names line and column or the parameter.
    """
    if query.get(MEDIA_TYPE) == GCODE:
        return _gcode(body, query, robot)
    reading = Reading(
        query.get("units"), query.get("angles"), query.get("columns"), query.get("free_axis")
    )
    choices = Choices(
        robot=query["robot"],
        interpolation=query.get("interpolation"),
        approach=query.get("approach"),
        start=_start(query),
        frame=_frame(query, robot),
        tool=frame_of(_numbers(query, "tool"), "tool") if "tool" in query else None,
    )
    slides = robot.prismatic.tolist()
    joints = [JointName(n, s) for n, s in zip(robot.joint_names, slides, strict=True)]
    points = read_points(body, reading, joints)
    document, notes = request_of(points, choices)
    told = [{"text": note.text, "guessed": note.guessed} for note in (*points.notes, *notes)]
    return headed(told, _finished(document, query))


def _gcode(body: bytes, query: Mapping[str, str], robot: Robot) -> bytes:
    """Return the request document for a G-code file, with the notes as its head."""
    misplaced = next((name for name in _NOT_FOR_GCODE if name in query), None)
    if misplaced is not None:
        raise InvalidRequest(f"{misplaced}: does not go with G-code", field=misplaced)
    toolpath = read_toolpath(body, query.get("units"))
    path: dict[str, Any] = {}
    if "approach" in query:
        path["approach"] = query["approach"]
    if "free_axis" in query:
        path["orientation_free"] = {"about": f"tool_{query['free_axis'][-1]}"}
    if (frame := _frame(query, robot)) is not None:
        path["frame"] = frame
    given: dict[str, Any] = {"robot": query["robot"], "path": path}
    if (start := _start(query)) is not None:
        given["start"] = start
    if "tool" in query:
        given["tool"] = frame_of(_numbers(query, "tool"), "tool")
    told = [{"text": note, "guessed": False} for note in toolpath.notes]
    return headed(told, _finished(gcode_request(toolpath, given), query))


def _finished(document: dict[str, Any], query: Mapping[str, str]) -> bytes:
    """Return a request document with what the query adds to any file's, checked."""
    if "scene" in query:
        document["scene"] = query["scene"]
    if "tool_speed" in query:
        document.setdefault("limits", {})["tool_speed"] = _number(query, "tool_speed")
    if "rate_hz" in query:
        document["sampling"] = {"rate_hz": _number(query, "rate_hz")}
    parse(PlanRequest, document)
    return json.dumps(document, allow_nan=False).encode()


def _start(query: Mapping[str, str]) -> Any:
    word = query.get("start", "home")
    if word in ("home", "free"):
        return None if word == "home" else word
    return _numbers(query, "start")


def _frame(query: Mapping[str, str], robot: Robot) -> dict[str, Any] | None:
    given = frame_of(_numbers(query, "frame"), "frame") if "frame" in query else None
    if "base_frame" not in query:
        return given
    if is_upload_id(query["robot"]):
        raise InvalidRequest(
            "base_frame: available for robots of the catalogue only; give the frame by its numbers "
            "(frame)",
            field="base_frame",
        )
    return frame_in_base(robot, query["base_frame"], given)


def _numbers(query: Mapping[str, str], name: str) -> list[float]:
    return [_finite(word, name) for word in query[name].split(",")]


def _number(query: Mapping[str, str], name: str) -> float:
    return _finite(query[name], name)


def _finite(word: str, name: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidRequest(
            f"{name}: {word[:200]!r} is not a finite number", field=name, allowed="finite numbers"
        )
    return value
