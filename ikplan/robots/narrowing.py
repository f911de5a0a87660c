"""Limits of single joints that a request narrows, as if they were the robot's own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ikplan.documents.limits import OwnLimits
from ikplan.errors import InvalidRequest, near_names
from ikplan.robots.description import JointSpec
from ikplan.robots.robot import Robot

__all__ = ["STANDS", "narrowed"]

STANDS = 1e-9
"""A joint whose lower limit is its upper one stands, within this [rad or m]."""


def narrowed(robot: Robot, joints: Mapping[str, OwnLimits] | None) -> Robot:
    """Return a robot with narrower limits; its home stays, inside them or not.

    Args:
        robot: The robot.
        joints: The limits by joint; None: as they are.

    Raises:
        InvalidRequest: No such joint, a limit that is wider than the robot's own, or a lower
            limit above the upper one.
    """
    if not joints:
        return robot
    for name in joints:
        if name not in robot.joint_names:
            near = near_names(name, robot.joint_names)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InvalidRequest(
                f"limits.joints: no joint {name!r}{hint}; there are {', '.join(robot.joint_names)}",
                field=f"limits.joints.{name}",
                allowed=list(robot.joint_names),
            )
    d = robot.description
    specs = tuple(_narrowed(j, joints[j.name]) if j.name in joints else j for j in d.joints)
    return Robot(replace(d, joints=specs))


def _narrowed(joint: JointSpec, asked: OwnLimits) -> JointSpec:
    changes: dict[str, float] = {}
    for key in ("lower", "upper", "velocity", "acceleration"):
        value = getattr(asked, key)
        if value is None:
            continue
        own = getattr(joint, key)
        field = f"limits.joints.{joint.name}.{key}"
        if joint.kind == "continuous" and key in ("lower", "upper"):
            raise InvalidRequest(
                f"{field}: {joint.name} turns without end; its range cannot be limited here",
                field=field,
                allowed="null",
            )
        if value < own if key == "lower" else value > own:
            raise InvalidRequest(
                f"{field}: {value:g} is wider than the robot's own {own:g}; a request can only "
                "narrow it: load the robot with other limits",
                field=field,
                allowed=f"{'>=' if key == 'lower' else '<='} {own:g}",
            )
        changes[key] = value
    lower, upper = changes.get("lower", joint.lower), changes.get("upper", joint.upper)
    if lower == upper:
        lower, upper = max(lower - STANDS, joint.lower), min(upper + STANDS, joint.upper)
    made = replace(
        joint,
        lower=lower,
        upper=upper,
        velocity=changes.get("velocity", joint.velocity),
        acceleration=changes.get("acceleration", joint.acceleration),
    )
    if made.lower > made.upper:
        raise InvalidRequest(
            f"limits.joints.{joint.name}: lower {made.lower:g} is above upper {made.upper:g}",
            field=f"limits.joints.{joint.name}",
        )
    return made
