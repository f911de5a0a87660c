"""A robot as one document that travels: a URDF and what is said with it."""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from ikplan.documents import Document, Floats, Number, load_json, parse
from ikplan.documents.controller import Controller
from ikplan.documents.poses import Frame
from ikplan.errors import InvalidRobot
from ikplan.robots.checks import unit_quaternion
from ikplan.robots.definition.couplings import user_joints
from ikplan.robots.definition.describe import moving_chain
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import RobotDescription, ShapeSource, Tool
from ikplan.robots.loading.home import with_good_home
from ikplan.robots.loading.tip import pick_chain
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.describe_urdf import Given, describe_urdf
from ikplan.robots.urdf.mesh_uris import mesh_notes
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
        None,
        gt=0,
        description="Acceleration limit [rad/s^2 or m/s^2]; null: the velocity limit, reached in "
        "0.6 s, named as an assumption in certificates.",
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
    tip: _Name | None = Field(
        None, description="Tip link; null: the group's, or the tool frame of the only arm."
    )
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
        description="Home, shape (dof,) [rad or m]; null: the SRDF's if it is not singular, or a "
        "well conditioned posture near the middle of the ranges.",
    )
    coupling: dict[_Name, dict[_Name, Number]] | None = Field(
        None,
        max_length=64,
        description="For a controller that counts joints otherwise than the URDF: joints of the "
        'URDF as sums of factors times the controller\'s joints, as {"J3": {"J2": 1, "J3": 1}} '
        "for a FANUC; null: as the URDF, with its mimic joints.",
    )
    velocity_default: _Name | None = Field(
        None,
        description="A default by name for turning joints whose velocity limit is 0 or absent: "
        '"90-deg-per-s"; null: they are refused.',
    )
    controller: Controller | None = Field(
        None,
        description="Its controller: cycle, jerk limits, languages; null: not known. Its base "
        "frame is in the base link.",
    )
    rules: Literal[1, 2] = Field(
        2,
        description="The rules for what is not given. 2: as said above. 1: those of the first "
        "uploads, which stay as they were: the only end is the tip, home is near zero, and the "
        "velocity limit is reached in 0.25 s.",
    )

    def canonical(self) -> bytes:
        """Return the document in the one form that its id is taken from.

        A robot of the first rules has the id that it had when there were no others.
        """
        later = ("controller", "coupling", "velocity_default")
        left_out = {field for field in later if getattr(self, field) is None}
        if self.rules == 1:
            left_out.add("rules")
        return self.model_dump_json(exclude=left_out).encode()

    @classmethod
    def stored(cls, document: bytes) -> RobotUpload:
        """Read a document in the canonical form; one that names no rules is of the first ones.

        Raises:
            InvalidRequest: A field is wrong.
        """
        content = load_json(document)
        if isinstance(content, dict):
            content.setdefault("rules", 1)
        return parse(cls, content)

    def content_id(self) -> str:
        """Return the robot's name: the same content, the same name."""
        return f"urdf-{hashlib.sha256(self.canonical()).hexdigest()[:32]}"

    def describe(self) -> RobotDescription:
        """Check all that can be checked without Pinocchio, and describe the robot.

        Raises:
            InvalidRobot: The XML is too large, too deep or has a DTD; there are too many joints
                or links; it is not one tree; several arms, and no tip; or a chain, axis, limit or
                home makes no sense.
        """
        return self._described()[0]

    def _described(self) -> tuple[RobotDescription, str]:
        """The description, and where its home comes from; empty: from nowhere."""
        name, document = self.content_id(), self.urdf.encode()
        tree = parse_urdf(document, robot=name)
        notes = mesh_notes(document, robot=name)
        base, tip, home = self.base, self.tip, dict[str, float]()
        if self.srdf is not None:
            group = read_group(self.srdf.encode(), tree, group=self.group, robot=name)
            base, tip, home = base or group.base, tip or group.tip, group.home
        elif self.group is not None:
            raise InvalidRobot(
                f"{name}: the group {self.group!r} needs an SRDF", robot=name, value=self.group
            )
        if tip is None and self.rules == 1 and len(tree.leaves(base or tree.root)) == 1:
            tip = tree.leaves(base or tree.root)[0]
        if tip is None:
            base, tip, chosen = pick_chain(tree, base)
            notes += chosen
        base = base or tree.root
        if self.home is not None:
            home = self._home(tree, base, tip)
        described = describe_urdf(
            tree,
            base=base,
            tip=tip,
            name=name,
            title=self.title,
            source="the uploaded URDF",
            given=Given(
                entries=[JointEntry(**limits.model_dump()) for limits in self.joints],
                home=home,
                tool=Tool(
                    _three(self.tool.position),
                    unit_quaternion(self.tool.quaternion_xyzw, "tool.quaternion_xyzw"),
                ),
                controller=self.controller,
                coupling=self.coupling,
                velocity_default=self.velocity_default,
                first_rules=self.rules == 1,
            ),
            notes=notes,
        )
        srdf = b"" if self.srdf is None else self.srdf.encode()
        described = replace(described, shapes=ShapeSource(urdf=document, srdf=srdf))
        return described, "the SRDF's home" if home and self.home is None else ""

    def robot(self) -> Robot:
        """Build the robot.

        Raises:
            InvalidRobot: As :meth:`describe`, or Pinocchio refuses the description.
        """
        description, home = self._described()
        if self.home is not None or self.rules == 1:
            return Robot(description)
        return with_good_home(description, home)

    def _home(self, tree: KinematicTree, base: str, tip: str) -> dict[str, float]:
        chain = user_joints(moving_chain(tree, base, tip))
        given = self.home or []
        if len(given) != len(chain):
            raise InvalidRobot(
                f"{tree.name}: home: {len(chain)} values expected "
                f"({', '.join(j.name for j in chain)}), got {len(given)}",
                robot=tree.name,
                value=given,
            )
        return {joint.name: value for joint, value in zip(chain, given, strict=True)}


def _three(v: list[float]) -> tuple[float, float, float]:
    return (v[0] + 0.0, v[1] + 0.0, v[2] + 0.0)
