"""A file of points on the command line, as a request."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ikplan import points as tables  # its readers are imported where there is a table
from ikplan.cli.requests.robot import is_file, robot_of
from ikplan.cli.terminal.telling import tell_notes
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = [
    "changes_of_path",
    "choices_as_changes",
    "is_points",
    "joint_names",
    "plan_of_points",
    "read_joint_rows",
]

_SUFFIXES = (".csv", ".tsv", ".txt")


def is_points(name: str, data: bytes) -> bool:
    """Whether a file holds a table of points, and no JSON."""
    lowered = name.lower()
    if lowered.endswith((".json", ".jsonl")):
        return False
    return lowered.endswith(_SUFFIXES) or data.lstrip()[:1] not in (b"{", b"[", b"")


def joint_names(options: argparse.Namespace) -> list[tables.JointName]:
    """Return the joints of the robot of ``--robot``."""
    robot = robot_of(options)
    if robot is not None:
        slides = robot.prismatic.tolist()
        return [tables.JointName(n, s) for n, s in zip(robot.joint_names, slides, strict=True)]
    if options.robot_override is None or is_file(options.robot_override):
        return []
    from ikplan.client import Client

    with Client(options.server) as client:
        joints = client.robot(options.robot_override)["joints"]
    return [tables.JointName(joint["name"], joint["type"] == "prismatic") for joint in joints]


def plan_of_points(options: argparse.Namespace, data: bytes) -> dict[str, Any]:
    """Return the request for a plan through the points of a file, and tell how it was read.

    Raises:
        InvalidRequest: The file or an option is wrong; names line and column, or the option.
    """
    reading = tables.Reading(options.units, options.angles, options.columns, options.free_axis)
    points = tables.read_points(data, reading, joint_names(options))
    choices = tables.Choices(
        robot=options.robot_override,
        interpolation=options.interpolation,
        approach=options.approach,
        start=_start(options),
        frame=_path_frame(options),
        tool=None if options.tool is None else tables.frame_of(options.tool, "--tool"),
    )
    request, notes = tables.request_of(points, choices)
    tell_notes(options, [*points.notes, *notes])
    return request


def read_joint_rows(options: argparse.Namespace, data: bytes) -> list[list[float]]:
    """Return the joint values of a file, for a timing; without a header in the robot's order.

    Raises:
        InvalidRequest: The file is wrong, or has poses.
    """
    joints = joint_names(options)
    columns = None
    if tables.has_no_header(data):
        columns = ",".join(joint.name for joint in joints) or None
    points = tables.read_points(
        data, tables.Reading(options.units, options.angles, columns), joints
    )
    if points.poses:
        raise InvalidRequest(
            "the file has poses; a timing needs joint values (ikplan plan reads poses)",
            field="waypoints",
            allowed="rows of joint values",
        )
    tell_notes(options, points.notes)
    return points.joints


def choices_as_changes(options: argparse.Namespace) -> dict[str, Any]:
    """Return what the options for a path change in a request document.

    Raises:
        InvalidRequest: An option belongs to a file of points.
    """
    for name in ("units", "angles", "columns"):
        if getattr(options, name) is not None:
            raise InvalidRequest(f"--{name} belongs to a file of points", field="command line")
    return changes_of_path(options)


def changes_of_path(options: argparse.Namespace) -> dict[str, Any]:
    """Return what the options for a path change, those of files left out.

    Raises:
        InvalidRequest: An option has a wrong value.
    """
    path: dict[str, Any] = {}
    for name in ("interpolation", "approach"):
        if getattr(options, name) is not None:
            path[name] = getattr(options, name)
    if options.free_axis is not None:
        path["orientation_free"] = {"about": f"tool_{options.free_axis[-1]}"}
    if (frame := _path_frame(options)) is not None:
        path["frame"] = frame
    changes: dict[str, Any] = {"path": path} if path else {}
    if options.tool is not None:
        changes["tool"] = tables.frame_of(options.tool, "--tool")
    if (start := _start(options)) is not None:
        changes["start"] = start
    return changes


def _start(options: argparse.Namespace) -> Any:
    """Joint values, ``"free"``, or None for home."""
    words: Sequence[str] | None = options.start
    if words is None or list(words) == ["home"]:
        return None
    if list(words) == ["free"]:
        return "free"
    try:
        return [float(word) for word in words]
    except ValueError as error:
        raise InvalidRequest(
            f"--start: home, free or joint values are allowed, not {' '.join(words)!r}",
            field="--start",
        ) from error


def _path_frame(options: argparse.Namespace) -> dict[str, Any] | None:
    """The frame of the points: given, or one of the robot's, or one given in one of the robot's."""
    given = None if options.frame is None else tables.frame_of(options.frame, "--frame")
    if options.base_frame is None:
        return given
    robot = _robot_here(options)
    from ikplan.robots.base_frames import frame_in_base

    return frame_in_base(robot, options.base_frame, given)


def _robot_here(options: argparse.Namespace) -> Robot:
    robot = robot_of(options)
    if robot is None:
        raise InvalidRequest(
            "--base-frame: name a robot that is here, by --robot", field="--base-frame"
        )
    return robot
