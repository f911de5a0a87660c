"""``ikplan time``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.cli.outputs import check_formats, check_outputs, draw, report
from ikplan.cli.requests.changes import merged, set_values
from ikplan.cli.requests.points import is_points, read_joint_rows
from ikplan.cli.requests.robot import info_of, name_robot
from ikplan.cli.requests.scene import set_scene, with_meshes_beside
from ikplan.cli.terminal.progress import progress_bar, watched
from ikplan.cli.terminal.telling import tell_start
from ikplan.documents import MAX_PLAN_S, load_json
from ikplan.documents.timing_request import TimingRequest
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.plans.plan import Plan
    from ikplan.robots import Robot

__all__ = ["time"]


def time(options: argparse.Namespace) -> None:
    """Time a joint path, here or by a service, and write the trajectory."""
    check_outputs(options)
    document = _document(options)
    tell_start(options, "loading")
    robot = name_robot(options, document)
    set_scene(options, document)
    set_values(document, options.set)
    check_formats(options, info_of(options, document, robot) if options.output else None)
    made = _by_service(options, document) if options.server else _here(options, document, robot)
    draw(made, options, document, TimingRequest, robot)
    report(made, options)


def _document(options: argparse.Namespace) -> Any:
    """The request of the files and options; a file that cannot be read raises OSError."""
    name = options.path
    data = sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
    if options.robot is not None and options.robot_override is not None:
        raise _unclear()
    if options.robot is not None:
        options.robot_override = options.robot
    if is_points(name, data):
        if options.robot_override is None:
            raise _unclear()
        read: Any = read_joint_rows(options, data)
    else:
        read = with_meshes_beside(load_json(data), name)
    if isinstance(read, dict) and options.robot is None:
        document: dict[str, Any] = read
    elif isinstance(read, list) and options.robot_override is not None:
        document = {"robot": options.robot_override, "waypoints": read}
    else:
        raise _unclear()
    changes: dict[str, Any] = {}
    if options.rate is not None:
        changes["sampling"] = {"rate_hz": options.rate}
    limits = {"jerk": options.jerk, "velocity_scale": options.scale}
    limits |= {"acceleration_scale": options.scale, "duration": options.duration}
    if present := {key: value for key, value in limits.items() if value is not None}:
        changes["limits"] = present
    return merged(document, changes)


def _unclear() -> InvalidRequest:
    return InvalidRequest(
        "give either a request document, or a robot (a name, or --robot FILE) and a file of "
        "joint values: a JSON list of rows, or CSV",
        field="command line",
    )


def _here(options: argparse.Namespace, document: Any, robot: Robot | None) -> Plan:
    from ikplan.pipeline.retime import time_request

    with progress_bar(quiet=options.quiet) as progress:
        return time_request(document, robot=robot, progress=progress)


def _by_service(options: argparse.Namespace, document: Any) -> Plan:
    from ikplan.client import Client

    with Client(options.server, timeout=MAX_PLAN_S) as client:
        return watched(
            lambda: client.time(document),
            lambda: client.submit_time(document),
            quiet=options.quiet,
        )
