"""A robot as one document that travels: a URDF and what is said with it."""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace
from typing import Annotated

from pydantic import Field

from ikplan.documents import Document, Floats, Number
from ikplan.documents.controller import Controller
from ikplan.documents.poses import Frame
from ikplan.errors import InvalidRobot
from ikplan.robots.checks import unit_quaternion
from ikplan.robots.definition.describe import moving_chain
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import RobotDescription, ShapeSource, Tool
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.describe_urdf import describe_urdf
from ikplan.robots.urdf.mesh_uris import mesh_packages
from ikplan.robots.urdf.safe_xml import MAX_BYTES
from ikplan.robots.urdf.srdf import read_group
from ikplan.robots.urdf.tree import KinematicTree
from ikplan.robots.urdf.urdf import parse_urdf

__all__ = ["JointLimits", "RobotUpload", "is_upload_id"]

_ID = re.compile(r"urdf-[0-9a-f]{32}")
_Name = Annotated[str, Field(min_length=1, max_length=200)]


def is_upload_id(name: str) -> bool:
    """Whether a robot's name is the id of an uploaded one."""
    return _ID.fullmatch(name) is not None


class JointLimits(Document):
    """Limits of one joint that replace the URDF's; what is absent stays as it is there."""

    name: _Name = Field(description="Name of a joint between base and tip.")
    lower: Number | None = Field(None, description="Lower position limit [rad or m].")
    upper: Number | None = Field(None, description="Upper position limit [rad or m].")
    velocity: Number | None = Field(None, gt=0, description="Velocity limit [rad/s or m/s].")
    acceleration: Number | None = Field(
        None, gt=0, description="Acceleration limit [rad/s^2 or m/s^2]; none: velocity / 0.25 s."
    )
    effort: Number | None = Field(None, ge=0, description="Effort limit [N m or N].")


class RobotUpload(Document):
    """A robot of one's own: a URDF and what it does not say."""

    urdf: str = Field(min_length=1, max_length=MAX_BYTES, description="The URDF, as text.")
    srdf: str | None = Field(
        None,
        min_length=1,
        max_length=MAX_BYTES,
        description="An SRDF of it: the chain of a group, and its state named home, are used.",
    )
    group: _Name | None = Field(
        None, description="Group of the SRDF; null: the only one that is a chain."
    )
    base: _Name | None = Field(None, description="Base link; null: the group's, or the root.")
    tip: _Name | None = Field(None, description="Tip link; null: the group's, or the only end.")
    title: _Name = Field("uploaded robot", description="A name for people.")
    tool: Frame = Field(
        default_factory=Frame,
        description="The tool frame in the tip frame, unless a request has its own.",
    )
    joints: list[JointLimits] = Field(
        [], max_length=64, description="Limits that replace the URDF's."
    )
    home: Floats | None = Field(
        None,
        max_length=64,
        description="Home, shape (dof,) [rad or m]; null: the SRDF's, or near zero.",
    )
    controller: Controller | None = Field(
        None,
        description="Its controller: cycle, jerk limits, languages; null: not known. Its base "
        "frame is in the base link.",
    )

    def canonical(self) -> bytes:
        """Return the document in the one form that its id is taken from.

        A robot without a controller has the id that it had before there were controllers.
        """
        left_out = {"controller"} if self.controller is None else None
        return self.model_dump_json(exclude=left_out).encode()

    def content_id(self) -> str:
        """Return the robot's name: the same content, the same name."""
        return f"urdf-{hashlib.sha256(self.canonical()).hexdigest()[:32]}"

    def describe(self) -> RobotDescription:
        """Check all that can be checked without Pinocchio, and describe the robot.

        Raises:
            InvalidRobot: The XML is too large, too deep or has a DTD; there are too many joints
                or links; it is not one tree; a mesh's address could leave its package; or a
                chain, axis, limit or home makes no sense.
        """
        name, document = self.content_id(), self.urdf.encode()
        tree = parse_urdf(document, robot=name)
        packages = mesh_packages(document, robot=name)
        base, tip, home = self.base, self.tip, {}
        if self.srdf is not None:
            group = read_group(self.srdf.encode(), tree, group=self.group, robot=name)
            base, tip, home = base or group.base, tip or group.tip, group.home
        elif self.group is not None:
            raise InvalidRobot(
                f"{name}: the group {self.group!r} needs an SRDF", robot=name, value=self.group
            )
        if self.home is not None:
            home = self._home(tree, base, tip)
        description = describe_urdf(
            tree,
            base=base,
            tip=tip,
            name=name,
            title=self.title,
            source="the uploaded URDF",
            entries=[JointEntry(**limits.model_dump()) for limits in self.joints],
            home=home,
            tool=Tool(
                _three(self.tool.position),
                unit_quaternion(self.tool.quaternion_xyzw, "tool.quaternion_xyzw"),
            ),
            notes=_mesh_notes(packages),
            controller=self.controller,
        )
        srdf = b"" if self.srdf is None else self.srdf.encode()
        return replace(description, shapes=ShapeSource(urdf=document, srdf=srdf))

    def robot(self) -> Robot:
        """Build the robot.

        Raises:
            InvalidRobot: As :meth:`describe`, or Pinocchio refuses the description.
        """
        return Robot(self.describe())

    def _home(self, tree: KinematicTree, base: str | None, tip: str | None) -> dict[str, float]:
        base = base or tree.root
        chain = moving_chain(tree, base, tip or tree.default_tip(base))
        given = self.home or []
        if len(given) != len(chain):
            raise InvalidRobot(
                f"{tree.name}: home: {len(chain)} values wanted "
                f"({', '.join(j.name for j in chain)}), got {len(given)}",
                robot=tree.name,
                value=given,
            )
        return {joint.name: value for joint, value in zip(chain, given, strict=True)}


def _mesh_notes(packages: list[str]) -> list[str]:
    named = ", ".join(p for p in packages if p) or "paths beside the URDF"
    return [f"meshes are not needed and were not opened: {named}"] if packages else []


def _three(v: list[float]) -> tuple[float, float, float]:
    return (v[0] + 0.0, v[1] + 0.0, v[2] + 0.0)
