"""One joint of a description: its limits and home, merged and checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.defaults import ACCELERATION_DEFAULTS, VELOCITY_DEFAULTS
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import JointSpec, LimitSource
from ikplan.robots.urdf.tree import Joint

__all__ = ["joint_spec"]

_REMEDY = f": give one, or ask for a default ({', '.join(VELOCITY_DEFAULTS)}; turning joints only)"


def joint_spec(
    entry: JointEntry,
    joint: Joint | None,
    home: float | None,
    sources: Sequence[LimitSource],
    robot: str,
    unit: float,
) -> JointSpec:
    """Merge what is said of a joint with its own limits and the named defaults, and check it.

    Args:
        entry: What is said of it, in ``unit``.
        joint: The joint of the URDF, for what is not said; None: there is none.
        home: Its home, in ``unit``; None: zero, or the middle of a range without zero.
        sources: Where each kind of limit comes from, with the names of the defaults.
        robot: Name of the robot, for messages.
        unit: One unit of angle [rad].

    Raises:
        InvalidRobot: A limit is missing or makes no sense.
    """
    kind = entry.type or (joint.kind if joint is not None else "revolute")
    if joint is not None and entry.type is not None and joint.kind != entry.type:
        raise InvalidRobot(
            f"{robot}: joint {entry.name!r} is {joint.kind}, not {entry.type}",
            robot=robot,
            joint=entry.name,
            value=entry.type,
        )
    if kind == "prismatic":
        unit = 1.0
    defaults: Mapping[str, str | None] = {s.limit: s.default for s in sources}

    def given(key: str, scale: float) -> float | None:
        value: float | None = getattr(entry, key)
        if value is not None:
            return value * scale
        return getattr(joint.limit, key) if joint is not None else None

    lower, upper = given("lower", unit), given("upper", unit)
    velocity, acceleration = given("velocity", unit), given("acceleration", unit)
    if not velocity and kind != "prismatic" and (default := defaults.get("velocity")) is not None:
        velocity = VELOCITY_DEFAULTS[default]
    velocity = _positive(velocity, "velocity", entry.name, robot)
    if acceleration is None and (default := defaults.get("acceleration")) is not None:
        acceleration = ACCELERATION_DEFAULTS[default](velocity)
    acceleration = _positive(acceleration, "acceleration", entry.name, robot)
    effort = given("effort", 1.0)
    if effort is not None and effort < 0:
        raise _wrong(robot, entry.name, "effort", effort, "it must not be negative")
    if kind == "continuous":
        lower, upper = -math.inf, math.inf
    missing = [
        key
        for key, value in (("lower", lower), ("upper", upper))
        if value is None or (math.isinf(value) and kind != "continuous")
    ]
    if lower is None or upper is None or missing:
        raise InvalidRobot(
            f"{robot}: joint {entry.name!r} is {kind} and has no {missing[0]} position limit "
            f"(beyond {1e6 if kind == 'prismatic' else 1e3:g} counts as none); give one",
            robot=robot,
            joint=entry.name,
        )
    if lower > upper:
        raise _wrong(robot, entry.name, "lower", lower, f"it is above the upper limit {upper:g}")
    if lower == upper:
        raise _wrong(
            robot, entry.name, "lower", lower, "it equals the upper limit; make the joint fixed"
        )
    if home is None:
        home = 0.0 if lower <= 0.0 <= upper else 0.5 * (lower + upper)
    else:
        home *= unit
    if not lower <= home <= upper:
        raise _wrong(robot, entry.name, "home", home, f"it is outside [{lower:g}, {upper:g}]")
    # URDF requires an effort attribute, and 0 is what authors write when they know none.
    effort = effort or math.nan
    return JointSpec(entry.name, kind, lower, upper, velocity, acceleration, effort, home)


def _positive(value: float | None, key: str, joint: str, robot: str) -> float:
    if value is None:
        remedy = _REMEDY if key == "velocity" else ""
        raise InvalidRobot(
            f"{robot}: joint {joint!r} has no {key} limit{remedy}", robot=robot, joint=joint
        )
    if not value > 0:
        unknown = key == "velocity" and value == 0
        why = (
            f"it must be positive; 0 means not known{_REMEDY}" if unknown else "it must be positive"
        )
        raise _wrong(robot, joint, key, value, why)
    return value


def _wrong(robot: str, joint: str, key: str, value: float, why: str) -> InvalidRobot:
    what = "home" if key == "home" else f"{key} limit"
    return InvalidRobot(
        f"{robot}: joint {joint!r}: the {what} is {value:g}: {why}",
        robot=robot,
        joint=joint,
        value=value,
    )
