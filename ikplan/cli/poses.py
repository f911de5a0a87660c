"""Single poses: ``ikplan fk`` and ``ikplan ik``."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ikplan.arrays import Array
from ikplan.cli.requests.robot import named_or_loaded
from ikplan.cli.requests.scene import set_scene
from ikplan.cli.terminal.output import number, say, say_json, table
from ikplan.cli.terminal.telling import tell, tell_start
from ikplan.errors import InvalidRequest
from ikplan.points.units import ANGLES

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["fk", "ik", "outside_limits"]

_SLACK = 1e-6
"""How far over a limit counts as rounding [rad or m]: limits are copied with few digits."""


def fk(options: argparse.Namespace) -> None:
    """Place the tool.

    Raises:
        InvalidRequest: A unit or a joint value is wrong.
        RobotNotFound: No robot of that name.
    """
    from ikplan.pipeline.forward_kinematics import fk_request

    robot = named_or_loaded(options, options.robot)
    q = _in_radians(options, robot)
    pose = fk_request({"robot": robot.name, "q": q}, robot=robot)
    for warning in outside_limits(robot, q):
        tell(options, f"warning: {warning}")
    if options.json:
        say_json(pose.model_dump(mode="json"))
        return
    rows = [
        ("position [m]", *(number(v, 6) for v in pose.position)),
        ("quaternion xyzw", *(number(v, 6) for v in pose.quaternion_xyzw)),
    ]
    rows[0] += ("",)
    say(*table((), rows))


def _in_radians(options: argparse.Namespace, robot: Robot) -> list[float]:
    """The joint values, those of turning joints from the unit of the options."""
    unit = options.angles or "rad"
    if unit not in ANGLES:
        raise InvalidRequest(
            f"--angles: {', '.join(ANGLES)} are allowed, not {unit!r}",
            field="--angles",
            allowed=list(ANGLES),
        )
    q: list[float] = list(options.q)
    if len(q) != robot.dof:  # for the request's own check
        return q
    slides = robot.prismatic.tolist()
    return [v if slide else v * ANGLES[unit] for v, slide in zip(q, slides, strict=True)]


def outside_limits(robot: Robot, q: Sequence[float]) -> list[str]:
    """Return what to say of joint values beyond the limits, in words; nothing of those within.

    Args:
        robot: The robot.
        q: Joint values, shape (dof,) [rad or m].
    """
    said = []
    rows = zip(
        robot.joint_names,
        q,
        robot.lower.tolist(),
        robot.upper.tolist(),
        robot.prismatic.tolist(),
        strict=True,
    )
    beyond = [row for row in rows if not row[2] - _SLACK <= row[1] <= row[3] + _SLACK]
    for name, value, lower, upper, slides in beyond:
        unit = "m" if slides else "rad"
        said.append(
            f"{name} = {value:g} {unit} is outside its limits {lower:g} .. {upper:g} {unit}"
        )
    turned = np.where(robot.prismatic, q, np.radians(q))
    if any(not row[4] for row in beyond) and _all_within(robot, turned):
        said.append("in degrees all values would be within the limits: --angles deg")
    return said


def _all_within(robot: Robot, q: Array) -> bool:
    return bool(np.all((robot.lower - _SLACK <= q) & (q <= robot.upper + _SLACK)))


def ik(options: argparse.Namespace) -> None:
    """Find joint values."""
    tell_start(options, "loading")
    from ikplan.pipeline.poses import solve_ik_request

    robot = named_or_loaded(options, options.robot)
    settings = {"method": options.method, "seed": options.seed}
    request: dict[str, Any] = {
        "robot": robot.name,
        "position": options.position,
        "quaternion_xyzw": options.quaternion,
        "start": options.start,
        "ik": {name: value for name, value in settings.items() if value is not None},
    }
    set_scene(options, request)
    solution = solve_ik_request(request, robot=robot)
    if options.json:
        say_json(solution.model_dump(mode="json"))
        return
    joints = robot.info().joints
    rows = []
    for joint, value in zip(joints, solution.q.tolist(), strict=True):
        turning = joint.type != "prismatic"
        degrees = number(math.degrees(value), 3) + " deg" if turning else ""
        rows.append((joint.name, number(value, 6) + (" rad" if turning else " m"), degrees))
    say(*table((), rows))
    errors = f"{solution.position_error:.1e} m"
    if solution.orientation_error is not None:
        errors += f", {solution.orientation_error:.1e} rad"
    say("", f"error {errors}; joint distance from the start {solution.elongation:.4f}")
    say(f"{solution.evaluations} evaluations of forward kinematics")
