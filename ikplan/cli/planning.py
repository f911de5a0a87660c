"""``ikplan plan`` and ``ikplan move``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.cli.outputs import check_formats, check_outputs, draw, report
from ikplan.cli.requests.changes import merged, set_values
from ikplan.cli.requests.gcode import is_gcode, plan_of_gcode
from ikplan.cli.requests.points import choices_as_changes, is_points, plan_of_points
from ikplan.cli.requests.robot import info_of, name_robot
from ikplan.cli.requests.scene import set_scene, with_meshes_beside
from ikplan.cli.terminal import collecting
from ikplan.cli.terminal.progress import progress_bar, watched
from ikplan.cli.terminal.telling import tell, tell_start
from ikplan.documents import MAX_PLAN_S, load_json
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import IkplanError, InvalidRequest

if TYPE_CHECKING:
    from ikplan.plans.plan import Plan
    from ikplan.robots import Robot

__all__ = ["move", "plan"]


def plan(options: argparse.Namespace) -> None:
    """Make a plan, here or by a service, and write it."""
    check_outputs(options)
    if options.repair is not None and options.repair < 1:
        raise InvalidRequest("--repair: repairs count from 1", field="--repair", allowed="1 ...")
    document = _document(options)
    tell_start(options, "loading")
    robot = name_robot(options, document)
    set_scene(options, document)
    set_values(document, options.set)
    check_formats(options, info_of(options, document, robot) if options.output else None)
    made, document = _repaired(options, document, robot)
    draw(made, options, document, PlanRequest, robot)
    report(made, options)


def move(options: argparse.Namespace) -> None:
    """Make the plan of one move, here or by a service, and write it.

    Raises:
        InvalidRequest: No goal is given, or more than one kind of it.
    """
    check_outputs(options)
    document = _move_document(options)
    tell_start(options, "loading")
    robot = name_robot(options, document)
    set_scene(options, document)
    set_values(document, options.set)
    check_formats(options, info_of(options, document, robot) if options.output else None)
    made = _make(options, document, robot)
    draw(made, options, document, PlanRequest, robot)
    report(made, options)


def _move_document(options: argparse.Namespace) -> dict[str, Any]:
    """The request of one move."""
    goals, position = options.goal or [], options.position
    if bool(goals) == (position is not None) or (options.quaternion and position is None):
        raise InvalidRequest(
            "give either --goal, once or several times, or --position with or without --quaternion",
            field="command line",
        )
    segment: dict[str, Any] = {"type": "move"}
    if position is not None:
        segment["to"] = {"position": position, "quaternion_xyzw": options.quaternion}
    elif len(goals) == 1:
        segment["q"] = goals[0]
    else:
        segment["any"] = [{"q": goal} for goal in goals]
    ik = {"effort": options.effort, "seed": options.seed}
    options.robot_override = options.robot
    return {
        "robot": options.robot,
        "start": options.start,
        "path": {"segments": [segment]},
        "ik": {key: value for key, value in ik.items() if value is not None},
        "sampling": {} if options.rate is None else {"rate_hz": options.rate},
        "limits": {} if options.duration is None else {"duration": options.duration},
    }


def _document(options: argparse.Namespace) -> Any:
    """The request of a file and of the options; a file that cannot be read raises OSError."""
    name = options.request
    data = sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
    if is_gcode(name):
        document: Any = plan_of_gcode(options, data)
    elif is_points(name, data):
        document = plan_of_points(options, data)
    else:
        document = with_meshes_beside(load_json(data), name)
        changes = choices_as_changes(options)
        if changes and isinstance(document, dict):
            document = merged(document, changes)
    if options.rate is not None and isinstance(document, dict):
        document = merged(document, {"sampling": {"rate_hz": options.rate}})
    if options.duration is not None and isinstance(document, dict):
        document = merged(document, {"limits": {"duration": options.duration}})
    return document


def _repaired(
    options: argparse.Namespace, document: Any, robot: Robot | None
) -> tuple[Plan, dict[str, Any]]:
    """The plan of a request, or of the request with the repair that the options choose."""
    try:
        made = _make(options, document, robot)
    except IkplanError as error:
        repairs: list[dict[str, Any]] | None = getattr(error, "repairs", None)
        if options.repair is None or repairs is None:
            raise
        if options.repair > len(repairs):
            tell(options, f"there is no repair {options.repair}")
            raise
        repair = repairs[options.repair - 1]
        tell(options, f"no plan as asked for; repair {options.repair}: {repair['detail']}")
        document = merged(document, repair["change"])
        return _make(options, document, robot), document
    if options.repair is not None:
        tell(options, "there is a plan without a repair")
    return made, document


def _make(options: argparse.Namespace, document: Any, robot: Robot | None) -> Plan:
    if options.server:
        return _by_service(options, document)
    from ikplan.pipeline.plan import plan as make

    collecting.loaded()
    with progress_bar(quiet=options.quiet) as progress:
        return make(document, robot=robot, progress=progress)


def _by_service(options: argparse.Namespace, document: Any) -> Plan:
    from ikplan.client import Client

    collecting.loaded()
    with Client(options.server, timeout=MAX_PLAN_S) as client:
        return watched(
            lambda: client.plan(document), lambda: client.submit(document), quiet=options.quiet
        )
