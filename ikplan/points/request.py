"""From the points of a file to a request."""

from __future__ import annotations

from typing import Any

from ikplan.errors import InvalidRequest
from ikplan.points.choices import Choices
from ikplan.points.names import INTERPOLATIONS
from ikplan.points.note import Note
from ikplan.points.points import Points, Speed

__all__ = ["request_of"]


def request_of(points: Points, choices: Choices) -> tuple[dict[str, Any], list[Note]]:
    """Return the request for a plan through the points of a file.

    Poses become waypoints; where speeds or zones differ from point to point, they become segments
    with limits and blends. Joint values become joint segments.

    Args:
        points: The points.
        choices: The rest of the request.

    Returns:
        The request document, and what to say of how the points are joined.

    Raises:
        InvalidRequest: The choices do not fit the points.
    """
    allowed = {"interpolation": INTERPOLATIONS, "approach": ("path", "joint")}
    for name, valid in allowed.items():
        value = getattr(choices, name)
        if value is not None and value not in valid:
            raise InvalidRequest(
                f"{name}: {', '.join(valid)} are allowed, not {value!r}",
                field=name,
                allowed=list(valid),
            )
    if choices.robot is None:
        raise InvalidRequest(
            "robot: a file of points does not name a robot: give one (--robot NAME)", field="robot"
        )
    limits: dict[str, Any] = {}
    notes: list[Note] = []
    if points.joints:
        path = _joint_path(points, choices, limits)
        notes.append(Note("the points are ends of joint segments: one joint spline through them"))
    else:
        path = _tool_path(points, choices, limits, notes)
    if points.timed:
        notes.append(Note("the times are not kept: the plan is as fast as its limits allow"))
    if choices.frame:
        path["frame"] = choices.frame
    if choices.approach is not None:
        path["approach"] = choices.approach
    request: dict[str, Any] = {"robot": choices.robot}
    if choices.start is not None:
        request["start"] = choices.start if choices.start == "free" else list(choices.start)
    if choices.tool:
        request["tool"] = choices.tool
    request["path"] = path
    if limits:
        request["limits"] = limits
    return request, notes


def _joint_path(points: Points, choices: Choices, limits: dict[str, Any]) -> dict[str, Any]:
    if any(points.zones):
        raise InvalidRequest(
            "a zone rounds a corner of the tool's path; joint values have none", field="zone"
        )
    for name in ("interpolation", "frame"):
        if getattr(choices, name) not in (None, "joint", {}):
            raise InvalidRequest(f"{name}: for poses; the file has joint values", field=name)
    speeds = _uniform(points.speeds, limits)
    segments: list[dict[str, Any]] = [{"type": "joint", "q": q} for q in points.joints]
    for segment, speed in zip(segments, speeds, strict=False):
        _limit(segment, speed)
    return {"segments": segments}


def _tool_path(
    points: Points, choices: Choices, limits: dict[str, Any], notes: list[Note]
) -> dict[str, Any]:
    rounded = any(points.zones)
    interpolation = choices.interpolation or ("line" if rounded else "joint")
    if rounded and interpolation != "line":
        raise InvalidRequest(
            "interpolation: zones round the corners between lines: line is allowed, not "
            f"{interpolation!r}",
            field="interpolation",
            allowed=["line"],
        )
    how = {
        "joint": "a joint spline (interpolation line: by straight lines)",
        "line": "straight lines",
        "spline": "a C2 curve",
    }
    notes.append(Note(f"the points are joined by {how[interpolation]}"))
    path: dict[str, Any] = {}
    speeds = _uniform(points.speeds, limits)
    # The last point has no corner.
    zones = [zone or 0.0 for zone in points.zones[:-1]]
    alike = len(set(zones)) <= 1
    if speeds and interpolation == "spline":
        raise InvalidRequest(
            "interpolation: speeds that differ from point to point need segments: line and joint "
            "are allowed, not 'spline'",
            field="interpolation",
            allowed=["line", "joint"],
        )
    if not speeds and alike:
        path["waypoints"] = points.poses
        if interpolation != "joint":
            path["interpolation"] = interpolation
        if zones and zones[0] > 0.0:
            path["blend"] = zones[0]
    else:
        path |= _segments(points, choices, interpolation, speeds, zones)
    if points.free_axis is not None:
        path["orientation_free"] = {"about": points.free_axis}
    return path


def _segments(
    points: Points,
    choices: Choices,
    interpolation: str,
    speeds: list[Speed | None],
    zones: list[float],
) -> dict[str, Any]:
    """Segments, each to one point, with the limits and the blend of its row."""
    path: dict[str, Any] = {}
    segments: list[dict[str, Any]] = []
    for k, pose in enumerate(points.poses):
        segment: dict[str, Any] = {"type": interpolation, "to": pose}
        if k < len(zones) and zones[k] > 0.0:
            segment["blend"] = zones[k]
        if speeds:
            _limit(segment, speeds[k])
        segments.append(segment)
    by_joints = choices.approach == "joint" or choices.start == "free"
    if interpolation == "line" and by_joints and len(segments) > 1:
        # No line leads to the first point: the lines begin there.
        path["begin"] = points.poses[0]
        del segments[0]
    path["segments"] = segments
    return path


def _uniform(speeds: list[Speed | None], limits: dict[str, Any]) -> list[Speed | None]:
    """The speeds that differ; one for all goes into the limits of the request instead."""
    if speeds and len(set(speeds)) == 1:
        if speeds[0] is not None:
            limits |= speeds[0].limits()
        return []
    return speeds


def _limit(segment: dict[str, Any], speed: Speed | None) -> None:
    if speed is not None:
        segment["limits"] = speed.limits()
