"""From a tree and what is said about it to a checked description."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ikplan.errors import InvalidRobot
from ikplan.robots.defaults import (
    ACCELERATION_DEFAULTS,
    DEFAULT_ACCELERATION,
    VELOCITY_DEFAULTS,
)
from ikplan.robots.description import Coupling, JointSpec, LimitSource, RobotDescription
from ikplan.robots.schema import JointEntry, RobotFile
from ikplan.robots.tree import MOVABLE, Joint, KinematicTree

__all__ = ["describe_file", "describe_urdf", "moving_chain"]


def moving_chain(tree: KinematicTree, base: str, tip: str) -> tuple[Joint, ...]:
    """The joints that move between ``base`` and ``tip``, in that order.

    Raises:
        InvalidRobot: There is none, one is floating, planar or a mimic, or has a zero axis.
    """
    chain = [j for j in tree.chain(base, tip) if j.kind != "fixed"]
    for joint in chain:
        if joint.kind not in MOVABLE:
            raise InvalidRobot(
                f"{tree.name}: joint {joint.name!r} between {base!r} and {tip!r} is "
                f"{joint.kind}; only {', '.join(MOVABLE)} joints can be on the chain",
                robot=tree.name,
                joint=joint.name,
                value=joint.kind,
                valid=MOVABLE,
            )
        if joint.mimic is not None:
            raise InvalidRobot(
                f"{tree.name}: joint {joint.name!r} on the chain mimics {joint.mimic!r}; "
                "mimic joints can only be beside the chain",
                robot=tree.name,
                joint=joint.name,
                value=joint.mimic,
            )
        if not any(joint.axis):
            raise InvalidRobot(
                f"{tree.name}: joint {joint.name!r} has a zero axis",
                robot=tree.name,
                joint=joint.name,
                value=list(joint.axis),
            )
    if not chain:
        raise InvalidRobot(
            f"{tree.name}: nothing moves between the base {base!r} and the tip {tip!r}",
            robot=tree.name,
            value=tip,
        )
    return tuple(chain)


def describe_urdf(
    tree: KinematicTree, *, base: str | None, tip: str | None, name: str, title: str, source: str
) -> RobotDescription:
    """Describe the chain of a bare URDF; accelerations are the default, home is near zero.

    Raises:
        InvalidRobot: The chain or one of its limits makes no sense.
    """
    base = tree.root if base is None else tree.require_link(base, "base")
    tip = tree.default_tip(base) if tip is None else tip
    chain = moving_chain(tree, base, tip)
    acceleration_given = all(j.limit.acceleration is not None for j in chain)
    sources = (
        LimitSource("position", source, None),
        LimitSource("velocity", source, None),
        LimitSource(
            "acceleration",
            source if acceleration_given else None,
            None if acceleration_given else DEFAULT_ACCELERATION,
        ),
        LimitSource("effort", source, None),
    )
    return RobotDescription(
        name=name,
        title=title,
        urdf=tree.to_urdf({j.name for j in chain}),
        base=base,
        tip=tip,
        joints=tuple(_spec(JointEntry(name=j.name), j, None, sources, name, 1.0) for j in chain),
        limit_sources=sources,
        sources=(f"kinematics and inertias: {source}",),
        notes=("home: zero, or the middle of the range where zero is outside it",),
        inertias_sourced=all(_has_inertia(tree, j.child) for j in chain),
    )


def describe_file(
    file: RobotFile,
    tree: KinematicTree,
    *,
    base: str | None = None,
    tip: str | None = None,
    name: str | None = None,
) -> RobotDescription:
    """Describe a robot of a ``robot.yaml``; ``base``, ``tip`` and ``name`` replace its own.

    Raises:
        InvalidRobot: The file and its kinematics do not fit, or a limit makes no sense.
    """
    own_chain = base in (None, file.base) and tip in (None, file.tip)
    base, tip = base or file.base, tip or file.tip
    chain = moving_chain(tree, base, tip)
    entries = {entry.name: entry for entry in file.joints}
    home = dict(zip(entries, file.home, strict=True)) if len(entries) == len(file.home) else {}
    if not home:
        raise InvalidRobot(f"{file.name}: joints: a name is given twice", robot=file.name)
    unit = math.radians(1.0) if file.angle_unit == "deg" else 1.0
    sources = _limit_sources(file)
    coupling = None
    joints: Sequence[Joint | None] = chain
    if file.coupling is not None:
        coupling = _coupling(file, chain)
        joints = [None] * len(file.joints)
        names = list(entries)
    else:
        names = [j.name for j in chain]
        if own_chain and names != list(entries):
            raise InvalidRobot(
                f"{file.name}: joints: {', '.join(entries)}; the chain from {base} to {tip} has "
                f"{', '.join(names)}, in that order",
                robot=file.name,
                value=list(entries),
                valid=names,
            )
    specs = tuple(
        _spec(entries.get(n, JointEntry(name=n)), joint, home.get(n), sources, file.name, unit)
        for n, joint in zip(names, joints, strict=True)
    )
    return RobotDescription(
        name=name or file.name,
        title=file.title,
        urdf=tree.to_urdf({j.name for j in chain}),
        base=base,
        tip=tip,
        joints=specs,
        coupling=coupling,
        limit_sources=sources,
        sources=tuple(str(s) for s in file.sources),
        notes=tuple(file.notes),
        inertias_sourced=file.inertias is not None,
    )


def _limit_sources(file: RobotFile) -> tuple[LimitSource, ...]:
    found = []
    for key in ("position", "velocity", "acceleration", "effort"):
        entry = getattr(file.limits, key)
        if entry is not None:
            found.append(LimitSource(key, entry.source, entry.default, entry.verified))
    return tuple(found)


def _coupling(file: RobotFile, chain: Sequence[Joint]) -> Coupling:
    assert file.coupling is not None
    matrix, offset = file.coupling.matrix, file.coupling.offset or [0.0] * len(chain)
    if len(matrix) != len(chain) or any(len(row) != len(file.joints) for row in matrix):
        raise InvalidRobot(
            f"{file.name}: coupling.matrix: {len(chain)} rows (serial joints) of "
            f"{len(file.joints)} numbers (joints) are wanted",
            robot=file.name,
            value="coupling.matrix",
        )
    if len(offset) != len(chain):
        raise InvalidRobot(
            f"{file.name}: coupling.offset: {len(chain)} numbers are wanted",
            robot=file.name,
            value="coupling.offset",
        )
    return Coupling(
        tuple(j.name for j in chain), tuple(tuple(row) for row in matrix), tuple(offset)
    )


def _spec(
    entry: JointEntry,
    joint: Joint | None,
    home: float | None,
    sources: Sequence[LimitSource],
    robot: str,
    unit: float,
) -> JointSpec:
    """Merge what is said of a joint with its own limits and the named defaults, and check it."""
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
    if velocity is None and (default := defaults.get("velocity")) is not None:
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
    if lower is None or upper is None:
        missing = "lower" if lower is None else "upper"
        raise InvalidRobot(
            f"{robot}: joint {entry.name!r} is {kind} and has no {missing} position limit",
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
        raise InvalidRobot(f"{robot}: joint {joint!r} has no {key} limit", robot=robot, joint=joint)
    if not value > 0:
        raise _wrong(robot, joint, key, value, "it must be positive")
    return value


def _wrong(robot: str, joint: str, key: str, value: float, why: str) -> InvalidRobot:
    what = "home" if key == "home" else f"{key} limit"
    return InvalidRobot(
        f"{robot}: joint {joint!r}: the {what} is {value:g}: {why}",
        robot=robot,
        joint=joint,
        value=value,
    )


def _has_inertia(tree: KinematicTree, link: str) -> bool:
    found = next(item for item in tree.links if item.name == link)
    return found.inertial is not None and found.inertial.mass > 0
