"""The robot of a command: of a request, by name, or of a file."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.errors import InvalidRequest, InvalidRobot, RobotNotFound

if TYPE_CHECKING:
    from ikplan.robots import Robot, RobotInfo

__all__ = ["info_of", "is_file", "name_robot", "robot_of"]

_SUFFIXES = (".urdf", ".xml", ".yaml", ".yml")


def is_file(robot: str) -> bool:
    """Whether ``--robot`` names a file or folder, and not a robot."""
    separators = [mark for mark in {"/", os.sep, os.altsep} if mark]
    return any(mark in robot for mark in separators) or robot.lower().endswith(_SUFFIXES)


def name_robot(options: argparse.Namespace, document: Any) -> Robot | None:
    """Write the robot of ``--robot`` into a document; one of a file is loaded, or uploaded.

    Returns:
        The robot of a file that plans are made for here or drawn with; None: the document's.

    Raises:
        InvalidRequest: Frames without a file.
        InvalidRobot: The file makes no sense.
    """
    robot: str | None = options.robot_override
    if robot is None or not is_file(robot):
        if options.base is not None or options.tip is not None:
            raise InvalidRequest("--base and --tip belong to --robot FILE", field="command line")
        if robot is not None and isinstance(document, dict):
            document["robot"] = robot
        return None
    file = Path(robot)
    if options.server is not None:
        _upload(file, options, document)
        if options.plot is None and options.plot_timing is None:
            return None
    from ikplan.robots import load_robot

    loaded = load_robot(file, base=options.base, tip=options.tip)
    if isinstance(document, dict) and options.server is None:
        document["robot"] = loaded.name
    return loaded


def _upload(file: Path, options: argparse.Namespace, document: Any) -> None:
    """Let the service have the robot of a file; its id then stands in the document."""
    if file.suffix in (".yaml", ".yml") or file.is_dir():
        raise InvalidRequest(
            f"--robot {file}: only a URDF can be uploaded to a service", field="command line"
        )
    from ikplan.client import Client

    frames = {"base": options.base, "tip": options.tip}
    with Client(options.server) as client:
        said = {key: link for key, link in frames.items() if link is not None}
        info = client.upload_robot(file.read_bytes(), title=file.stem or "robot", **said)
    if isinstance(document, dict):
        document["robot"] = info["name"]


def robot_of(options: argparse.Namespace) -> Robot | None:
    """Return the robot of ``--robot`` as it is here; None: there is none here of that name."""
    from ikplan.robots import load_robot, robot_names

    robot: str | None = options.robot_override
    if robot is None:
        return None
    if is_file(robot):
        return load_robot(Path(robot), base=options.base, tip=options.tip)
    if options.server is not None and robot not in robot_names():
        return None
    return load_robot(robot)


def info_of(options: argparse.Namespace, document: Any, loaded: Robot | None) -> RobotInfo | None:
    """Return what is known of the robot of a document; None: the request itself will be refused."""
    if loaded is not None:
        return loaded.info()
    name = document.get("robot") if isinstance(document, dict) else None
    if not isinstance(name, str) or not name:
        return None
    from ikplan.robots import RobotInfo, load_robot, robot_names

    if name in robot_names():
        return load_robot(name).info()
    if options.server is None:
        return None
    from ikplan.client import Client

    try:
        with Client(options.server) as client:
            return RobotInfo.model_validate(client.robot(name))
    except (RobotNotFound, InvalidRobot):
        return None
