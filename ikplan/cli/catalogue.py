"""What there is: ``ikplan robots``, ``ikplan solvers``, ``ikplan schema``."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

from ikplan.cli.controllers import controller_lines
from ikplan.cli.requests.robot import named_or_loaded
from ikplan.cli.terminal.output import number, say, say_json, table

if TYPE_CHECKING:
    from ikplan.robots import RobotInfo

__all__ = ["robots", "say_joints", "schema", "solvers"]


def robots(options: argparse.Namespace) -> None:
    """List the robots, or describe one."""
    if options.robot is not None:
        _robot(options)
        return
    if options.json:
        from ikplan.robots import load_robot, robot_names

        infos = [load_robot(name).info() for name in robot_names()]
        say_json({"robots": [info.model_dump(mode="json") for info in infos]})
        return
    from ikplan.robots.listing import listed_robots

    rows = [(robot.name, robot.title, str(robot.dof)) for robot in listed_robots()]
    say(*table(("name", "title", "joints"), rows, left=2))


def _robot(options: argparse.Namespace) -> None:
    from ikplan.cli.bodies import body_lines
    from ikplan.scene.describe import info_with_bodies

    info = info_with_bodies(named_or_loaded(options, options.robot))
    if options.json:
        say_json(info.model_dump(mode="json"))
        return
    say(f"{info.name}: {info.title}", f"{info.base_frame} -> {info.tip_frame}", "")
    say_joints(info)
    if info.controller is not None:
        say("", *controller_lines(info.controller))
    if info.collision is not None:
        say("", *body_lines(info.collision))
    if info.notes:
        say("", *(f"- {note}" for note in info.notes))
    if info.sources:
        say("", "sources:", *(f"- {source}" for source in info.sources))


def say_joints(info: RobotInfo) -> None:
    """Print the joints of a robot as a table: limits, home, and their units."""
    rows = []
    for joint in info.joints:
        turning = joint.type != "prismatic"
        values = (joint.lower, joint.upper, joint.home, joint.velocity, joint.acceleration)
        shown = [
            number(math.degrees(v) if turning and v is not None else v, 2 if turning else 4)
            for v in values
        ]
        effort = number(joint.effort, 1)
        rows.append((joint.name, joint.type, *shown, effort, "deg" if turning else "m"))
    titles = ("joint", "type", "lower", "upper", "home", "speed", "accel.", "effort", "unit")
    say(*table(titles, rows, left=2))


def solvers(options: argparse.Namespace) -> None:
    """List the solvers, or describe one."""
    from ikplan.ik import registry

    if options.solver is None:
        known = registry.solvers()
        if options.json:
            say_json({"solvers": [s.model_dump(mode="json") for s in known]})
            return
        rows = [(s.name, s.family, s.title) for s in known]
        say(*table(("name", "family", "title"), rows, left=3))
        return
    solver = registry.find_solver(options.solver)
    if options.json:
        say_json(solver.model_dump(mode="json"))
        return
    say(f"{solver.name}: {solver.title}", f"source: {solver.source}")
    for what, value in (("population", solver.population), ("iterations", solver.iterations)):
        if value is not None:
            say(f"{what}: {value}")
    if solver.notes:
        say(solver.notes)
    parameters = [
        (p.name, str(p.default), p.unit or "", " | ".join(p.choices or ()), p.description)
        for p in solver.parameters
    ]
    say("", *table(("parameter", "default", "unit", "choices", "meaning"), parameters, left=5))


def schema(options: argparse.Namespace) -> None:  # noqa: ARG001 - every command takes them
    """Print the JSON schema of the plan request."""
    from ikplan.documents.plan_request import json_schema

    say_json(json_schema())
