"""``ikplan robots add``: a robot of one's own, in one step."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.cli.catalogue import say_joints
from ikplan.cli.requests.robot import said_of
from ikplan.cli.terminal.output import say, say_json
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["add"]


def add(options: argparse.Namespace) -> None:
    """Read a robot, tell all that was found and assumed, and write or upload it.

    Raises:
        InvalidRequest: An option makes no sense.
        InvalidRobot: The description makes no sense, or there is a robot of that name.
        OSError: The folder cannot be written.
    """
    from ikplan.robots.folders import robot_names, user_folder
    from ikplan.robots.loading.checking import check_against_whole
    from ikplan.robots.loading.from_source import Said, robot_of_source
    from ikplan.robots.loading.sources import read_source, robot_yaml
    from ikplan.robots.loading.writing import catalogue_name, write_robot

    path = Path(options.source)
    if path.exists() and robot_yaml(path) is not None:
        raise InvalidRequest(
            f"{path} is a robot.yaml, which needs no adding: name its folder, or the folder of "
            "robots in IKPLAN_ROBOTS_PATH",
            field="FILE",
        )
    options.arg += options.arguments
    said = said_of(options)
    source = read_source(path, said.pop("args", {}))
    name = catalogue_name(options.name or source.file.name.split(".")[0])
    if name in robot_names() and not options.replace and options.server is None:
        raise InvalidRequest(
            f"there is a robot {name!r}; give another --name, or --replace to hide it",
            field="--name",
        )
    robot = robot_of_source(source, Said(**said), name=name)
    checked = check_against_whole(robot, source.urdf)
    if not options.json:
        _tell(robot, str(source), checked)
    if options.server is not None:
        from ikplan.client import Client
        from ikplan.robots.loading.uploading import upload_fields

        with Client(options.server) as client:
            info = client.upload_robot(source.urdf, **upload_fields(robot, source, said))
        _end(options, robot, f"uploaded as {info['name']}", {"uploaded": info["name"]})
        return
    folder = Path(options.folder) if options.folder is not None else user_folder()
    written = write_robot(folder, robot.description, source.urdf, replace=options.replace)
    _check_written(written, robot)
    used = name if options.folder is None else str(written)
    use = f"wrote {written}; use it: ikplan plan FILE --robot {used}"
    _end(options, robot, use, {"written": str(written)})


def _tell(robot: Robot, source: str, checked: str) -> None:
    info = robot.info()
    say(f"{info.name}: from {source}", f"{info.base_frame} -> {info.tip_frame}", "")
    say_joints(info)
    say("", "limits:", *(f"- {s.limit}: {_where(s.source, s.default)}" for s in info.limit_sources))
    assumed = info.assumptions or ["nothing"]
    say("", "assumed:", *(f"- {assumption}" for assumption in assumed))
    say("", "notes:", *(f"- {note}" for note in robot.description.notes))
    say(f"- {checked}", "")


def _where(source: str | None, default: str | None) -> str:
    return f"from {source}" if default is None else f"default {default} where no source gives one"


def _end(options: argparse.Namespace, robot: Robot, said: str, done: dict[str, Any]) -> None:
    if options.json:
        say_json({**done, "robot": robot.info().model_dump(mode="json")})
    else:
        say(said)


def _check_written(folder: Path, robot: Robot) -> None:
    """Read back what was written; it must be the same robot."""
    from ikplan.errors import InvalidRobot
    from ikplan.robots import load_robot

    again = load_robot(folder)
    if again.fingerprint != robot.fingerprint:
        raise InvalidRobot(
            f"{robot.name}: what was written to {folder} reads as another robot: a fault of ikplan",
            robot=robot.name,
        )
