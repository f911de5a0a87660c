"""The format of ``robot.yaml``, checked field by field."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import yaml
from pydantic import Field, ValidationError, model_validator

from ikplan.documents.controller import Controller, Source
from ikplan.errors import InvalidRobot
from ikplan.robots.definition.collision import CollisionEntry
from ikplan.robots.definition.defaults import ACCELERATION_DEFAULTS, VELOCITY_DEFAULTS
from ikplan.robots.definition.strict import Number, Strict, Triple
from ikplan.robots.yaml_text import load_yaml

__all__ = [
    "AxesKinematics",
    "DhKinematics",
    "JointEntry",
    "LimitEntry",
    "RobotFile",
    "UrdfKinematics",
    "read_robot_file",
]


class DhRow(Strict):
    """One row of a DH table: lengths in m, angles in the file's unit.

    With the modified convention, row i holds alpha and a of i-1, as such tables are printed.
    """

    d: Number
    a: Number
    alpha: Number
    theta_offset: Number = 0.0


class DhKinematics(Strict):
    """A chain given by a Denavit-Hartenberg table, one revolute joint a row."""

    convention: Literal["standard", "modified"]
    rows: Annotated[list[DhRow], Field(min_length=1, max_length=64)]


class Origin(Strict):
    """A frame in its parent: position [m], roll-pitch-yaw in the file's angle unit."""

    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)


class AxisJoint(Origin):
    """A serial joint: its frame in the frame of the joint before, and its axis there."""

    name: str
    type: Literal["revolute", "continuous", "prismatic"] = "revolute"
    axis: Triple


class AxesKinematics(Strict):
    """A chain given by joint origins and axes; ``frames`` are fixed to the last joint."""

    joints: Annotated[list[AxisJoint], Field(min_length=1, max_length=64)]
    frames: dict[str, Origin]


class UrdfKinematics(Strict):
    """A chain in a URDF file, of an installed package or beside ``robot.yaml``."""

    package: Literal["example-robot-data"] | None = None
    path: str


class Kinematics(Strict):
    """Exactly one way to give the chain."""

    dh: DhKinematics | None = None
    axes: AxesKinematics | None = None
    urdf: UrdfKinematics | None = None

    @model_validator(mode="after")
    def _one_of(self) -> Kinematics:
        if sum(v is not None for v in (self.dh, self.axes, self.urdf)) != 1:
            raise ValueError("give exactly one of dh, axes and urdf")
        return self


class JointEntry(Strict):
    """One joint of the user; for a URDF, what is absent is taken from the file."""

    name: str
    type: Literal["revolute", "continuous", "prismatic"] | None = None
    lower: Number | None = None
    upper: Number | None = None
    velocity: Number | None = None
    acceleration: Number | None = None
    effort: Number | None = None


class LimitEntry(Strict):
    """Where one kind of limit comes from: a source, or a default by its name."""

    source: str | None = None
    default: str | None = None
    verified: bool = True

    @model_validator(mode="after")
    def _one_of(self) -> LimitEntry:
        if (self.source is None) == (self.default is None):
            raise ValueError("give exactly one of source and default")
        return self


class Limits(Strict):
    """Where the limits come from; no ``effort`` means that no source gives one."""

    position: LimitEntry
    velocity: LimitEntry
    acceleration: LimitEntry
    effort: LimitEntry | None = None

    @model_validator(mode="after")
    def _known_defaults(self) -> Limits:
        for key, known in (
            ("velocity", VELOCITY_DEFAULTS),
            ("acceleration", ACCELERATION_DEFAULTS),
            ("position", {}),
            ("effort", {}),
        ):
            entry = getattr(self, key)
            if entry is not None and entry.default is not None and entry.default not in known:
                choices = ", ".join(known) or "none"
                raise ValueError(f"no {key} default {entry.default!r}; there is {choices}")
        return self


class CouplingEntry(Strict):
    """Serial joint values ``matrix @ q + offset``; one row a serial joint, offset [rad or m]."""

    matrix: list[list[Number]]
    offset: list[Number] | None = None


class RobotFile(Strict):
    """The content of a ``robot.yaml``; ``fixed_joints`` [rad or m] stand beside the chain."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,63}$")]
    title: str
    angle_unit: Literal["rad", "deg"] = "rad"
    sources: Annotated[list[Source], Field(min_length=1)]
    kinematics: Kinematics
    base: str
    tip: str
    joints: Annotated[list[JointEntry], Field(min_length=1, max_length=64)]
    limits: Limits
    coupling: CouplingEntry | None = None
    home: list[Number]
    inertias: str | None = None
    controller: Controller | None = None
    fixed_joints: dict[str, Number] = Field(default_factory=dict)
    collision: CollisionEntry | None = None
    notes: list[str] = Field(default_factory=list)

    @model_validator(mode="after")
    def _lengths(self) -> RobotFile:
        if len(self.home) != len(self.joints):
            raise ValueError(f"home has {len(self.home)} values for {len(self.joints)} joints")
        if self.controller is not None and not self.controller.sources:
            raise ValueError("controller.sources: name where its facts come from")
        return self


def read_robot_file(text: str, *, robot: str) -> RobotFile:
    """Read a ``robot.yaml``.

    Args:
        text: Its content.
        robot: Name of the robot or file, for messages.

    Raises:
        InvalidRobot: Not YAML, or a field is missing, unknown or wrong; it is named.
    """
    try:
        content: Any = load_yaml(text)
    except yaml.YAMLError as error:
        where = " ".join(str(error).split())
        raise InvalidRobot(f"{robot}: not YAML: {where}", robot=robot) from error
    except RecursionError as error:
        raise InvalidRobot(f"{robot}: nested too deep", robot=robot) from error
    if not isinstance(content, dict):
        raise InvalidRobot(f"{robot}: must be a mapping of fields", robot=robot)
    try:
        return RobotFile.model_validate(content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"]) or "robot.yaml"
        more = f" (and {error.error_count() - 1} more)" if error.error_count() > 1 else ""
        raise InvalidRobot(
            f"{robot}: {field}: {first['msg']}{more}", robot=robot, value=field
        ) from error
