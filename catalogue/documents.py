"""From the facts of an arm to its ``robot.yaml``."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable

from catalogue.bodies.sources import shape_source
from catalogue.facts import Arm, Facts, FactsJoint
from catalogue.homes import pick_home
from ikplan.robots.definition.defaults import DEFAULT_ACCELERATION

__all__ = ["robot_document"]

_QUARTER = math.pi / 2
_HEADER = "# Written by `python -m catalogue` from catalogue/facts.yaml: change it there.\n"


def robot_document(facts: Facts, arm: Arm) -> str:
    """Write the ``robot.yaml`` of an arm.

    Angles are in rad, as published; those of a description's frames that are a quarter turn to
    1e-8 rad are a quarter turn, since the facts are rounded to 1e-9.

    Args:
        facts: All facts, for the source and the controller.
        arm: The arm.
    """
    source = facts.source_of(arm)
    name = source.repository.partition("/")[2]
    description = f"{name}, commit {source.commit}, {arm.file}"
    lines = [_HEADER + f"name: {arm.name}", f"title: {_text(arm.title)}", "sources:"]
    lines += _fact("kinematics and limits", description)
    accelerations = arm.acceleration_document
    if arm.acceleration_file is not None:
        accelerations = f"{name}, commit {source.commit}, {arm.acceleration_file}"
    if accelerations is not None:
        lines += _fact("acceleration limits", accelerations)
    if arm.counting is not None:
        lines += _fact("coupling", arm.counting.source)
    for meshes in shape_source(arm.name):
        lines += _fact("shapes of the links", f"meshes of {meshes.package}")
    lines += ["kinematics:", "  axes:", "    joints:"]
    lines += [f"      - {_origin(joint)}" for joint in arm.joints]
    tool = _flow(xyz=_triple(arm.tool.xyz), rpy=_turns(arm.tool.rpy))
    lines += ["    frames:", f"      {arm.tip}: {tool}", f"base: {arm.base}", f"tip: {arm.tip}"]
    lines += ["joints:", *(f"  - {limits}" for limits in _limits(arm)), "limits:"]
    counted = arm.counting.limits if arm.counting is not None else None
    lines += [
        _limit("position", counted or description),
        _limit("velocity", counted or description),
    ]
    if accelerations is not None:
        lines.append(_limit("acceleration", accelerations))
    else:
        lines.append(f"  acceleration: {{default: {DEFAULT_ACCELERATION}}}")
    if arm.counting is None and any(joint.effort is not None for joint in arm.joints):
        lines.append(_limit("effort", description))
    if arm.counting is not None:
        lines += ["coupling:", "  matrix:"]
        lines += [f"    - {_triple(row)}" for row in arm.counting.matrix]
    lines.append(f"home: {_triple(pick_home(arm))}")
    if arm.controller is not None:
        block = facts.controllers[arm.controller].model_dump(mode="json", exclude_unset=True)
        lines.append(f"controller: {json.dumps(block, ensure_ascii=False)}")
    if shape_source(arm.name):
        lines += ["collision:", "  file: collision.json"]
    lines += ["notes:", *(f"  - {_text(note)}" for note in _notes(facts, arm))]
    return "\n".join(lines) + "\n"


def _notes(facts: Facts, arm: Arm) -> Iterable[str]:
    source = facts.source_of(arm)
    if source.official:
        yield f"official: the description is the maker's own ({source.repository})"
    else:
        yield (
            f"not official: the description is written from data sheets by members of "
            f"ROS-Industrial ({source.repository}), not by the maker"
        )
    yield (
        "home: the best conditioned of 64 fixed postures in the middle 60 % of each range "
        "(catalogue/homes.py); no source gives one"
    )
    yield from arm.notes


def _limits(arm: Arm) -> Iterable[str]:
    if arm.counting is not None:
        for counted in arm.counting.joints:
            yield _flow(
                name=counted.name,
                type="revolute",
                lower=_number(counted.lower),
                upper=_number(counted.upper),
                velocity=_number(counted.velocity),
            )
        return
    for joint in arm.joints:
        given = {
            key: _number(value)
            for key in ("lower", "upper", "velocity", "acceleration", "effort")
            if (value := getattr(joint, key)) is not None
        }
        yield _flow(name=joint.name, **given)


def _origin(joint: FactsJoint) -> str:
    fields = {"name": joint.name}
    if joint.type != "revolute":
        fields["type"] = joint.type
    if any(joint.xyz):
        fields["xyz"] = _triple(joint.xyz)
    if any(joint.rpy):
        fields["rpy"] = _turns(joint.rpy)
    return _flow(**fields, axis=_triple(joint.axis))


def _turns(rpy: Iterable[float]) -> str:
    """Roll, pitch and yaw; a quarter turn to 1e-8 rad is one."""
    exact = []
    for angle in rpy:
        quarters = round(angle / _QUARTER) * _QUARTER
        exact.append(quarters if abs(angle - quarters) < 1e-8 else angle)
    return _triple(exact)


def _fact(fact: str, source: str) -> list[str]:
    return [f"  - fact: {fact}", f"    source: {_text(source)}"]


def _limit(kind: str, source: str) -> str:
    return f"  {kind}: {{source: {_text(source)}}}"


def _flow(**fields: str) -> str:
    return "{" + ", ".join(f"{key}: {value}" for key, value in fields.items()) + "}"


def _triple(values: Iterable[float]) -> str:
    return "[" + ", ".join(map(_number, values)) + "]"


def _number(value: float) -> str:
    return str(int(value)) if value == int(value) else repr(value)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
