"""Single poses: ``ikplan fk`` and ``ikplan ik``."""

from __future__ import annotations

import argparse
import math
from typing import Any

from ikplan.cli.output import number, say, say_json, table

__all__ = ["fk", "ik"]


def fk(options: argparse.Namespace) -> None:
    """Place the tool."""
    from ikplan.pipeline import fk_request

    pose = fk_request({"robot": options.robot, "q": options.q})
    if options.json:
        say_json(pose.model_dump(mode="json"))
        return
    rows = [
        ("position [m]", *(number(v, 6) for v in pose.position)),
        ("quaternion xyzw", *(number(v, 6) for v in pose.quaternion_xyzw)),
    ]
    rows[0] += ("",)
    say(*table((), rows))


def ik(options: argparse.Namespace) -> None:
    """Find joint values."""
    from ikplan.pipeline import solve_ik_request
    from ikplan.robots import load_robot

    settings = {"method": options.method, "seed": options.seed}
    request: dict[str, Any] = {
        "robot": options.robot,
        "position": options.position,
        "quaternion_xyzw": options.quaternion,
        "start": options.start,
        "ik": {name: value for name, value in settings.items() if value is not None},
    }
    solution = solve_ik_request(request)
    if options.json:
        say_json(solution.model_dump(mode="json"))
        return
    joints = load_robot(options.robot).info().joints
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
