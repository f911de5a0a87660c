"""What goes to a service with the URDF of a robot that was loaded here."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ikplan.robots.definition.assumptions import is_assumed
from ikplan.robots.loading.sources import RobotSource
from ikplan.robots.robot import Robot

__all__ = ["upload_fields"]


def upload_fields(robot: Robot, source: RobotSource, said: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of an upload that gives the same robot, without its URDF.

    Args:
        robot: The robot as it was loaded, with the files of its package.
        source: The description.
        said: What was said with it.
    """
    d = robot.description
    joints = []
    for joint in d.joints:
        entry: dict[str, Any] = {"name": joint.name}
        for key in ("lower", "upper", "velocity", "acceleration", "effort"):
            value = getattr(joint, key)
            if math.isfinite(value) and not is_assumed(d.assumptions, key, joint.name):
                entry[key] = value
        joints.append(entry)
    fields = {
        "base": d.base,
        "tip": d.tip,
        "title": source.tree.name or "robot",
        "joints": joints,
        "home": robot.home.tolist(),
    }
    for key in ("coupling", "velocity_default"):
        if said.get(key):
            fields[key] = said[key]
    return fields
