"""What can be typed."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import ikplan
from ikplan.cli.batch_options import add_batch
from ikplan.cli.maps.place_options import add_place
from ikplan.cli.maps.reach_options import add_reach
from ikplan.cli.options import (
    add_changes,
    add_json,
    add_outputs,
    add_path,
    add_robot,
    add_robot_frames,
    add_scene,
    add_talk,
)
from ikplan.cli.studies.compare_options import add_compare
from ikplan.cli.terminal import collecting
from ikplan.cli.terminal.exit_codes import NO_PLAN
from ikplan.errors import InvalidRequest

__all__ = ["as_one_command", "make_parser", "numbers_as_values"]

ADD = "robots-add"
"""What the parser calls ``robots add``: ``robots`` alone takes the name of a robot."""
ROLES = ("planner", "reader", "auditor", "monitor")
"""What a key of the service may do."""
SHELLS = ("bash", "zsh", "tcsh")
"""Shells that there is a completion for."""


class _Parser(argparse.ArgumentParser):
    """Tells a wrong command line as it tells a wrong request: one line, exit code 2."""

    def __init__(self, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)

    def error(self, message: str) -> NoReturn:
        raise InvalidRequest(f"{message} (see {self.prog} --help)", field="command line")


def as_one_command(arguments: list[str]) -> list[str]:
    """Return a command line with ``robots add`` as the one word that the parser knows."""
    if arguments[:2] == ["robots", "add"]:
        return [ADD, *arguments[2:]]
    return arguments


def numbers_as_values(arguments: Sequence[str]) -> list[str]:
    """Keep argparse from taking ``-1e-3`` for an option: with a space before it, it cannot."""
    values = []
    for argument in arguments:
        if argument.startswith("-"):
            with contextlib.suppress(ValueError):
                float(argument)
                argument = " " + argument
        values.append(argument)
    return values


def _command(
    module: str, function: str, *, brief: bool = False
) -> Callable[[argparse.Namespace], int | None]:
    """A command that imports what it needs when it runs: help and other commands need less.

    Args:
        module: Its module.
        function: Its function there.
        brief: Whether it is over soon, or says itself when it is loaded.
    """

    def run(options: argparse.Namespace) -> int | None:
        command = getattr(importlib.import_module(f"ikplan.cli.{module}"), function)
        if not brief:
            collecting.loaded()
        code: int | None = command(options)
        return code

    return run


def make_parser() -> argparse.ArgumentParser:
    """Return the parser; every command sets ``run``, a function of the options."""
    parser = _Parser(prog="ikplan", description="A tool path in, a certified joint trajectory out.")
    parser.add_argument("--version", action="version", version=f"ikplan {ikplan.__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    robots = commands.add_parser(
        "robots", help="list the robots, or describe one; robots add: bring one of your own"
    )
    robots.add_argument(
        "robot", nargs="?", metavar="ROBOT", help="a name, or a file (URDF, xacro, DH table)"
    )
    add_robot_frames(robots)
    add_json(robots)
    robots.set_defaults(run=_command("catalogue", "robots", brief=True))

    new_robot = commands.add_parser(
        ADD,
        prog="ikplan robots add",
        help="bring a robot of your own: ikplan robots add FILE [NAME:=VALUE ...]",
        description="Reads a URDF, a xacro file, a DH table or a package's folder, tells what was "
        "found and assumed, and writes a robot of the catalogue. xacro evaluates expressions of "
        "the file: add files that you trust.",
    )
    new_robot.add_argument("source", metavar="FILE", help="the file or folder")
    new_robot.add_argument(
        "arguments",
        nargs="*",
        metavar="NAME:=VALUE",
        help="arguments of a xacro file, or settings of a DH table",
    )
    new_robot.add_argument("--name", help="name of the robot; absent: that of the file")
    new_robot.add_argument(
        "--folder",
        metavar="FOLDER",
        help="folder of robots to write to; absent: the first of IKPLAN_ROBOTS_PATH, or "
        "~/.config/ikplan/robots",
    )
    new_robot.add_argument(
        "--replace", action="store_true", help="replace or hide a robot of that name"
    )
    new_robot.add_argument("--server", metavar="URL", help="upload it to that service instead")
    add_robot_frames(new_robot)
    add_json(new_robot)
    new_robot.set_defaults(run=_command("adding", "add"))

    solvers = commands.add_parser("solvers", help="list the solvers of joint values")
    solvers.add_argument("solver", nargs="?", metavar="SOLVER", help="a name: its parameters")
    add_json(solvers)
    solvers.set_defaults(run=_command("catalogue", "solvers"))

    fk = commands.add_parser("fk", help="place the tool: joint values to tool pose")
    fk.add_argument("robot", metavar="ROBOT", help="a name or a file")
    add_robot_frames(fk)
    fk.add_argument("q", nargs="+", type=float, metavar="Q", help="joint values [rad or m]")
    fk.add_argument("--angles", metavar="UNIT", help="unit of the angles: rad (if absent), deg")
    add_json(fk)
    add_talk(fk)
    fk.set_defaults(run=_command("poses", "fk", brief=True))

    ik = commands.add_parser("ik", help="find joint values: tool pose to joint values")
    ik.add_argument("robot", metavar="ROBOT", help="a name or a file")
    add_robot_frames(ik)
    ik.add_argument(
        "--position",
        nargs=3,
        type=float,
        required=True,
        metavar=("X", "Y", "Z"),
        help="tool position in the base [m]",
    )
    ik.add_argument(
        "--quaternion",
        nargs=4,
        type=float,
        metavar=("X", "Y", "Z", "W"),
        help="tool orientation; absent: any",
    )
    ik.add_argument(
        "--start",
        nargs="+",
        type=float,
        metavar="Q",
        help="joint values to stay close to [rad or m]; absent: the robot's home",
    )
    add_scene(ik)
    ik.add_argument("--method", help="a solver (see ikplan solvers)")
    ik.add_argument("--seed", type=int, help="seed of every random choice")
    add_json(ik)
    add_talk(ik)
    ik.set_defaults(run=_command("poses", "ik", brief=True))

    plan = commands.add_parser("plan", help="make a plan from a request or a file of points")
    plan.add_argument(
        "request",
        metavar="FILE",
        help="a request in JSON, or points in CSV; - for standard input",
    )
    add_outputs(plan)
    add_robot(plan)
    add_scene(plan)
    add_changes(plan)
    plan.add_argument(
        "--repair",
        type=int,
        metavar="N",
        help="where there is no plan: apply the repair of that number, and plan again",
    )
    add_path(plan)
    add_json(plan)
    add_talk(plan)
    plan.set_defaults(run=_command("planning", "plan", brief=True))

    move = commands.add_parser(
        "move",
        help="move around obstacles to joint values or a tool pose",
        description="A single move: ikplan plan has whole paths. Between its ends the tool goes "
        "anywhere; the finished motion is proven to be free of contact.",
    )
    move.add_argument("robot", metavar="ROBOT", help="a name or a file")
    move.add_argument(
        "--start",
        nargs="+",
        type=float,
        metavar="Q",
        help="joint values at the start [rad or m]; absent: the robot's home",
    )
    move.add_argument(
        "--goal",
        action="append",
        nargs="+",
        type=float,
        metavar="Q",
        help="joint values to go to [rad or m]; given several times: to the one with the shortest "
        "way found",
    )
    move.add_argument(
        "--position",
        nargs=3,
        type=float,
        metavar=("X", "Y", "Z"),
        help="or the tool position to go to, in the base [m]",
    )
    move.add_argument(
        "--quaternion",
        nargs=4,
        type=float,
        metavar=("X", "Y", "Z", "W"),
        help="with --position: tool orientation; absent: any",
    )
    add_scene(move)
    move.add_argument("--effort", type=int, help="samples drawn at most in the search")
    move.add_argument("--seed", type=int, help="seed of the search")
    add_changes(move)
    add_outputs(move)
    add_robot_frames(move)
    add_json(move)
    add_talk(move)
    move.set_defaults(run=_command("planning", "move", brief=True))

    many = commands.add_parser(
        "batch",
        help="answer many requests: JSON lines in, a row for each out",
        description="Every line is a request, and answered by a row: "
        '{"index": 0, "status": 200, "plan": ...} or {..., "problem": ...}, in their order. '
        f"Exit code {NO_PLAN}: done, but not every request has a plan.",
    )
    add_batch(many)
    many.set_defaults(run=_command("batch", "batch"), plot=None, plot_timing=None)

    reach = commands.add_parser(
        "reach",
        help="map which poses a robot reaches",
        description="Positions on a grid, orientations spread evenly; Parquet with a row for each "
        "pose, and a figure.",
    )
    add_reach(reach)
    reach.set_defaults(run=_command("maps.reach", "reach"))

    place = commands.add_parser(
        "place",
        help="find where to put the part, or the robot's base",
        description="A search with the planner as its objective: each placement is planned in "
        "full, and the best ones are certified plans. "
        f"Exit code {NO_PLAN}: no placement that was looked at has a plan.",
    )
    add_place(place)
    place.set_defaults(run=_command("maps.place", "place"), server=None)

    compare = commands.add_parser(
        "compare",
        help="compare searches on the same targets",
        description="The same targets, starts, objective and evaluations for all; tests over "
        "targets with Holm's correction, a figure, and rows that COCO's tools read.",
    )
    add_compare(compare)
    compare.set_defaults(run=_command("studies.compare", "compare"))

    time = commands.add_parser("time", help="time a joint path: no planning")
    time.add_argument("robot", nargs="?", metavar="ROBOT", help="a name, with joint values")
    time.add_argument(
        "path",
        metavar="FILE",
        help="a request document, or with a robot: joint values as a JSON list of rows, or CSV",
    )
    add_robot(time)
    add_scene(time)
    add_changes(time)
    time.add_argument("--angles", metavar="UNIT", help="unit of angles in a CSV file: rad, deg")
    time.add_argument("--units", metavar="UNIT", help="unit of lengths in a CSV file: m, mm, ...")
    time.add_argument("--scale", type=float, help="share of the robot's limits")
    time.add_argument("--jerk", type=float, help="highest joint jerk [rad/s^3 or m/s^3]")
    add_outputs(time)
    add_json(time)
    add_talk(time)
    time.set_defaults(run=_command("timing", "time"))

    serve = commands.add_parser(
        "serve", help="start the service", description="Settings are read from IKPLAN_... too."
    )
    serve.add_argument(
        "--host", default=os.environ.get("IKPLAN_HOST", "127.0.0.1"), help="address to listen on"
    )
    serve.add_argument(
        "--port", type=int, default=os.environ.get("IKPLAN_PORT", "8000"), help="0: any free port"
    )
    serve.add_argument("--workers", type=int, help="plans made at the same time; 0: all processors")
    serve.set_defaults(run=_command("serving", "serve"))

    kept = commands.add_parser("plans", help="list the plans and jobs of a service")
    kept.add_argument(
        "--server",
        metavar="URL",
        help="the service; absent: IKPLAN_SERVER, or the one on this machine",
    )
    kept.add_argument("--robot", metavar="NAME", help="only those of this robot")
    kept.add_argument("--outcome", help="only those: finished, failed or unfinished")
    kept.add_argument("--since", metavar="TIME", help="only those since this time (RFC 3339)")
    kept.add_argument("--until", metavar="TIME", help="only those before this time")
    kept.add_argument("--limit", type=int, default=100, metavar="N", help="most rows; else 100")
    add_json(kept)
    kept.set_defaults(run=_command("plans", "plans"))

    known = commands.add_parser("keys", help="keys of the service")
    key_commands = known.add_subparsers(title="commands", metavar="COMMAND", required=True)
    new = key_commands.add_parser("new", help="make a key, and its hash for IKPLAN_API_KEYS")
    new.add_argument("--name", help="what logs and metrics call its owner")
    new.add_argument("--role", choices=ROLES, help="what it may do; absent: planner")
    new.add_argument("--rate", help="its rate limit, such as 60/minute")
    new.add_argument("--jobs", type=int, help="most unfinished jobs that it may have")
    new.set_defaults(run=_command("keys", "new"))
    audit = key_commands.add_parser("audit", help="tell who planned what, by a service")
    audit.add_argument("--server", metavar="URL", help="the service; see ikplan plans")
    audit.add_argument("--owner", metavar="NAME", help="only what this key did")
    audit.add_argument("--limit", type=int, default=100, metavar="N", help="most rows; else 100")
    add_json(audit)
    audit.set_defaults(run=_command("keys", "audit"))

    schema = commands.add_parser("schema", help="print the JSON schema of the plan request")
    schema.set_defaults(run=_command("catalogue", "schema"))

    complete = commands.add_parser(
        "completion",
        help="print the script by which a shell completes this command",
        description="For bash: ikplan completion bash > "
        "~/.local/share/bash-completion/completions/ikplan",
    )
    complete.add_argument("shell", metavar="SHELL", help=", ".join(SHELLS))
    complete.set_defaults(run=_command("completion", "completion"), parser=parser)
    return parser
