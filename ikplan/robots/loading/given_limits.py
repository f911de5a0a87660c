"""Limits given with a robot: as a mapping, or in a file of the kind that MoveIt reads."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.schema import JointEntry

__all__ = ["LimitsGiven", "limit_entries", "read_joint_limits"]

LimitsGiven = Mapping[str, Mapping[str, float]] | str | Path
"""Limits by joint, ``{"J1": {"velocity": 2.0}}``, or the path of a ``joint_limits.yaml``."""

_KEYS = ("lower", "upper", "velocity", "acceleration", "effort")
_MOVEIT = {
    "velocity": ("has_velocity_limits", "max_velocity"),
    "acceleration": ("has_acceleration_limits", "max_acceleration"),
    "effort": ("has_effort_limits", "max_effort"),
    "lower": ("has_position_limits", "min_position"),
    "upper": ("has_position_limits", "max_position"),
}


class _Loader(yaml.SafeLoader):
    """Also reads ``!degrees 90`` and ``!radians 1.57``, as descriptions for ROS write angles."""


def _angle(unit: float) -> Any:
    def read(loader: yaml.SafeLoader, node: yaml.Node) -> float:
        assert isinstance(node, yaml.ScalarNode)
        try:
            return float(loader.construct_scalar(node)) * unit
        except ValueError as error:
            raise yaml.YAMLError(f"not an angle: {node.value!r}") from error

    return read


_Loader.add_constructor("!degrees", _angle(math.radians(1.0)))
_Loader.add_constructor("!radians", _angle(1.0))


def limit_entries(limits: LimitsGiven, *, robot: str) -> list[JointEntry]:
    """Return given limits as entries, in SI units.

    Args:
        limits: By joint: lower and upper [rad or m], velocity, acceleration [per second], effort
            [N m or N]; or the path of a ``joint_limits.yaml``.
        robot: Name of the robot, for messages.

    Raises:
        InvalidRobot: A field is unknown or no number, or the file makes no sense.
    """
    if isinstance(limits, str | Path):
        path = Path(limits)
        try:
            return read_joint_limits(path.read_bytes(), robot=robot)
        except OSError as error:
            raise InvalidRobot(
                f"{robot}: limits: {path}: cannot be read: {error.strerror}", robot=robot
            ) from error
    entries = []
    for joint, values in limits.items():
        unknown = sorted(set(values) - set(_KEYS))
        if unknown:
            raise InvalidRobot(
                f"{robot}: limits of {joint!r}: no limit {unknown[0]!r}; there are "
                f"{', '.join(_KEYS)}",
                robot=robot,
                joint=joint,
                valid=_KEYS,
            )
        entries.append(_entry(joint, values, robot))
    return entries


def read_joint_limits(document: bytes, *, robot: str) -> list[JointEntry]:
    """Read a ``joint_limits.yaml``: a mapping ``joint_limits`` with MoveIt's fields.

    Args:
        document: The bytes of the file.
        robot: Name of the robot, for messages.

    Returns:
        An entry a joint that has a limit; a limit that ``has_..._limits: false`` disowns, or that
        is not positive, is left out.

    Raises:
        InvalidRobot: Not such a file.
    """
    try:
        content = yaml.load(document, Loader=_Loader)  # a subclass of the safe loader
    except (yaml.YAMLError, RecursionError) as error:
        where = " ".join(str(error).split())
        raise InvalidRobot(f"{robot}: joint limits: not YAML: {where}", robot=robot) from error
    joints = content.get("joint_limits") if isinstance(content, dict) else None
    if not isinstance(joints, dict):
        raise InvalidRobot(
            f"{robot}: joint limits: must have a mapping 'joint_limits', a field for each joint",
            robot=robot,
        )
    entries = []
    for joint, fields in joints.items():
        if not isinstance(fields, dict):
            continue
        found = {
            key: fields[name]
            for key, (has, name) in _MOVEIT.items()
            if fields.get(has, True) is not False and fields.get(name) is not None
        }
        for key in ("velocity", "acceleration", "effort"):
            if isinstance(found.get(key), int | float) and not found[key] > 0:
                del found[key]  # what authors write who know none
        if found:
            entries.append(_entry(str(joint), found, robot))
    return entries


def _entry(joint: str, values: Mapping[str, Any], robot: str) -> JointEntry:
    try:
        return JointEntry(name=joint, **values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"])
        raise InvalidRobot(
            f"{robot}: limits of {joint!r}: {field}: {first['msg']}", robot=robot, joint=joint
        ) from error
