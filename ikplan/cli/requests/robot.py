"""The robot of a command: of a request, by name, or of a file."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.errors import InvalidRequest, InvalidRobot, RobotNotFound

if TYPE_CHECKING:
    from ikplan.robots import Robot, RobotInfo

__all__ = [
    "arguments_of",
    "info_of",
    "is_file",
    "load_file",
    "name_robot",
    "named_or_loaded",
    "robot_of",
    "upload_options",
]

_SUFFIXES = (".urdf", ".xacro", ".xml", ".yaml", ".yml", ".csv", ".sdf", ".mjcf")
"""Those of :data:`ikplan.robots.loading.sources.SUFFIXES`, without loading anything."""
_SAID = ("base", "tip", "home", "joint_limits", "velocity_default", "arg")
"""Options that belong to a robot of a file."""


def is_file(robot: str) -> bool:
    """Whether ``--robot`` names a file or folder, and not a robot."""
    separators = [mark for mark in {"/", os.sep, os.altsep} if mark]
    return any(mark in robot for mark in separators) or robot.lower().endswith(_SUFFIXES)


def _flag(option: str) -> str:
    return "--" + option.replace("_", "-")


def arguments_of(texts: Sequence[str]) -> dict[str, str]:
    """Return arguments ``name:=value`` by name.

    Raises:
        InvalidRequest: One has another form, or is given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, mark, value = text.partition(":=")
        if not mark or not name or name in found:
            raise InvalidRequest(
                f"{text!r}: arguments are name:=value, each once", field="command line"
            )
        found[name] = value
    return found


def said_of(options: argparse.Namespace) -> dict[str, Any]:
    """Return what the options say of a robot, as :func:`ikplan.load_robot` takes it.

    Raises:
        InvalidRequest: An option makes no sense.
    """
    said: dict[str, Any] = {"base": options.base, "tip": options.tip}
    said["velocity_default"] = options.velocity_default
    said["limits"] = None if options.joint_limits is None else Path(options.joint_limits)
    said["args"] = arguments_of(options.arg)
    if options.home is not None:
        try:
            said["home"] = [float(part) for part in options.home.replace(",", " ").split()]
        except ValueError as error:
            raise InvalidRequest(
                f"--home: expected numbers, one a joint, separated by commas, not {options.home!r}",
                field="--home",
            ) from error
    return {key: value for key, value in said.items() if value not in (None, {})}


def load_file(file: Path, options: argparse.Namespace) -> Robot:
    """Load the robot of a file or folder, with what the options say of it.

    Raises:
        InvalidRequest: An option makes no sense.
        InvalidRobot: The file makes no sense.
    """
    from ikplan.robots import load_robot

    return load_robot(file, **said_of(options))


def named_or_loaded(options: argparse.Namespace, robot: str) -> Robot:
    """Return the robot of a name or file of the command line, with what the options say of it.

    Raises:
        RobotNotFound: No robot of that name.
        InvalidRobot: The file makes no sense.
    """
    from ikplan.robots import load_robot

    return (
        load_file(Path(robot), options) if is_file(robot) else load_robot(robot, **said_of(options))
    )


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
        for option in _SAID:
            if getattr(options, option) not in (None, []):
                raise InvalidRequest(
                    f"{_flag(option)} belongs to --robot FILE", field="command line"
                )
        if robot is not None and isinstance(document, dict):
            document["robot"] = robot
        return None
    file = Path(robot)
    if options.server is not None:
        _upload(file, options, document)
        if options.plot is None and options.plot_timing is None:
            return None
    loaded = load_file(file, options)
    if isinstance(document, dict) and options.server is None:
        document["robot"] = loaded.name
    return loaded


def _upload(file: Path, options: argparse.Namespace, document: Any) -> None:
    """Let the service have the robot of a file; its id then stands in the document."""
    from ikplan.client import Client

    urdf, said = upload_options(file, options)
    with Client(options.server) as client:
        info = client.upload_robot(urdf, **said)
    if isinstance(document, dict):
        document["robot"] = info["name"]


def upload_options(file: Path, options: argparse.Namespace) -> tuple[bytes, dict[str, Any]]:
    """Return the URDF of a file, expanded, and what goes with it to a service.

    A URDF that nothing is found for beside it goes as it is: the service finds tip and home by the
    same rules.

    Raises:
        InvalidRequest: The file cannot be uploaded.
        InvalidRobot: The file makes no sense.
    """
    from ikplan.robots.loading.sources import read_source, robot_yaml
    from ikplan.robots.loading.uploading import upload_fields

    if robot_yaml(file) is not None:
        raise InvalidRequest(
            f"--robot {file}: a robot.yaml cannot be uploaded to a service; its URDF can",
            field="command line",
        )
    found = read_source(file, arguments_of(options.arg))
    return found.urdf, upload_fields(load_file(file, options), found, said_of(options))


def robot_of(options: argparse.Namespace) -> Robot | None:
    """Return the robot of ``--robot`` as it is here; None: there is none here of that name."""
    from ikplan.robots import load_robot, robot_names

    robot: str | None = options.robot_override
    if robot is None:
        return None
    if is_file(robot):
        return load_file(Path(robot), options)
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
