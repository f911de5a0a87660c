"""Other limits and another home for a robot that stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.assumptions import without_assumptions
from ikplan.robots.definition.joint_spec import joint_spec
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import JointSpec, RobotDescription

__all__ = ["HomeGiven", "home_by_joint", "with_changes"]

HomeGiven = Sequence[float] | Mapping[str, float]
"""A home: one value a joint in order, or values by joint [rad or m]."""


def home_by_joint(home: HomeGiven, names: Sequence[str], *, robot: str) -> dict[str, float]:
    """Return a home by joint.

    Raises:
        InvalidRobot: Not one number a joint, or a name is unknown.
    """
    if isinstance(home, Mapping):
        for name in home:
            _require(name, names, "home", robot)
        return {name: float(value) for name, value in home.items()}
    if len(home) != len(names):
        raise InvalidRobot(
            f"{robot}: home: {len(names)} values expected ({', '.join(names)}), got {len(home)}",
            robot=robot,
            value=list(home),
        )
    return {name: float(value) for name, value in zip(names, home, strict=True)}


def with_changes(
    description: RobotDescription,
    entries: Sequence[JointEntry] = (),
    home: HomeGiven | None = None,
) -> RobotDescription:
    """Return a description with other limits, and another home.

    Args:
        description: The robot.
        entries: Limits that replace its own, by joint [rad or m, per second, N m or N].
        home: The home that replaces its own.

    Raises:
        InvalidRobot: A joint is unknown, or a limit or the home makes no sense.
    """
    names = [joint.name for joint in description.joints]
    said = {entry.name: entry for entry in entries}
    for name in said:
        _require(name, names, "limits", description.name)
    homes = {} if home is None else home_by_joint(home, names, robot=description.name)
    joints = tuple(
        _changed(joint, said.get(joint.name), homes.get(joint.name), description.name)
        for joint in description.joints
    )
    sources, assumptions = list(description.limit_sources), description.assumptions
    for i, source in enumerate(sources):
        keys = ("lower", "upper") if source.limit == "position" else (source.limit,)
        given = [e for e in said.values() if any(getattr(e, k) is not None for k in keys)]
        if len(given) == len(names):
            sources[i] = replace(source, source="given when it was loaded", default=None)
            assumptions = without_assumptions(assumptions, source.limit)
        elif given and source.source is not None:
            sources[i] = replace(source, source=f"{source.source}, and given when it was loaded")
    return replace(
        description, joints=joints, limit_sources=tuple(sources), assumptions=assumptions
    )


def _changed(
    joint: JointSpec, entry: JointEntry | None, home: float | None, robot: str
) -> JointSpec:
    if entry is None and home is None:
        return joint
    own = {
        key: getattr(joint, key)
        for key in ("velocity", "acceleration")
        if entry is None or getattr(entry, key) is None
    }
    if joint.kind != "continuous":
        own |= {
            key: getattr(joint, key)
            for key in ("lower", "upper")
            if entry is None or getattr(entry, key) is None
        }
    merged = (entry or JointEntry(name=joint.name)).model_copy(update={"type": joint.kind, **own})
    if merged.effort is None and joint.effort == joint.effort:
        merged = merged.model_copy(update={"effort": joint.effort})
    value = joint.home if home is None else home
    if home is None and merged.lower is not None and merged.upper is not None:
        value = min(max(value, merged.lower), merged.upper)
    return joint_spec(merged, None, value, (), robot, 1.0)


def _require(name: str, names: Sequence[str], what: str, robot: str) -> None:
    if name not in names:
        raise InvalidRobot(
            f"{robot}: {what}: no joint {name!r}; there are {', '.join(names)}",
            robot=robot,
            joint=name,
            valid=list(names),
        )
