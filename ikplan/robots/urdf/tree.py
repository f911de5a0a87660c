"""Links and joints as plain data: what a URDF or a DH table comes down to."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from ikplan.errors import InvalidRobot, near_names

__all__ = ["MOVABLE", "Inertial", "Joint", "JointLimit", "KinematicTree", "Link", "Vector"]

Vector = tuple[float, float, float]
_ZERO: Vector = (0.0, 0.0, 0.0)

MOVABLE = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], centre of mass [m, rad] and inertia (ixx, ixy, ixz, iyy, iyz, izz) [kg m2]."""

    mass: float
    xyz: Vector
    rpy: Vector
    inertia: tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class Link:
    """A body, by name."""

    name: str
    inertial: Inertial | None = None
    fault: str = ""
    """What is wrong with its inertial, which is then left out; empty: nothing."""


@dataclass(frozen=True)
class JointLimit:
    """Limits as the description gives them [rad or m, per second, N m or N]; None: not given.

    A position limit beyond any joint's range is infinite: it counts as none.
    """

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    acceleration: float | None = None


@dataclass(frozen=True)
class Joint:
    """A joint from ``parent`` to ``child``.

    Attributes:
        name: Name of the joint.
        kind: revolute, continuous, prismatic, fixed, floating or planar.
        parent: Name of the parent link.
        child: Name of the child link.
        xyz: Origin of the joint frame in the parent link's frame [m].
        rpy: Fixed-axis roll, pitch, yaw of the joint frame in the parent link's frame [rad].
        axis: Joint axis in the joint frame, of unit length for movable joints.
        limit: Limits, as far as given.
        mimic: Name of the joint this one follows, or None.
        multiplier: Its value per unit of the value of the joint that it follows.
        offset: Its value where that joint is at zero [rad or m].
        faults: What is wrong with its numbers, which are then neutral ones.
    """

    name: str
    kind: str
    parent: str
    child: str
    xyz: Vector = _ZERO
    rpy: Vector = _ZERO
    axis: Vector = (0.0, 0.0, 1.0)
    limit: JointLimit = field(default_factory=JointLimit)
    mimic: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0
    faults: tuple[InvalidRobot, ...] = field(default=(), compare=False)


@dataclass(frozen=True)
class KinematicTree:
    """Links joined by joints; the constructor's caller has made sure that it is one tree."""

    name: str
    root: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]

    @property
    def link_names(self) -> list[str]:
        """Names of the links, in the order of the description."""
        return [link.name for link in self.links]

    def leaves(self, base: str) -> list[str]:
        """Links at or below ``base`` that have no child, in the order of the description."""
        children: dict[str, list[str]] = {name: [] for name in self.link_names}
        for joint in self.joints:
            children[joint.parent].append(joint.child)
        below: set[str] = set()
        pending = [base]
        while pending:
            link = pending.pop()
            below.add(link)
            pending += children[link]
        return [name for name in self.link_names if name in below and not children[name]]

    def require_link(self, name: str, role: str) -> str:
        """Return ``name`` if it is a link.

        Raises:
            InvalidRobot: It is not; the valid names are offered.
        """
        names = self.link_names
        if name in names:
            return name
        near = near_names(name, names)
        hint = f"; did you mean {' or '.join(near)}?" if near else "."
        shown = ", ".join(names[:40]) + (", ..." if len(names) > 40 else "")
        raise InvalidRobot(
            f"{self.name}: no link {name!r} to be the {role}{hint} Links: {shown}",
            robot=self.name,
            value=name,
            valid=names,
        )

    def with_kinds(self, kinds: Mapping[str, str]) -> KinematicTree:
        """The same tree with other kinds of joints.

        Args:
            kinds: The kind of each joint that changes, by its name.
        """
        joints = (replace(j, kind=kinds.get(j.name, j.kind)) for j in self.joints)
        return replace(self, joints=tuple(joints))

    def chain(self, base: str, tip: str) -> tuple[Joint, ...]:
        """Every joint from ``base`` to ``tip``, fixed ones included, in that order.

        Raises:
            InvalidRobot: No such link, or ``tip`` is not a descendant of ``base``.
        """
        self.require_link(base, "base")
        self.require_link(tip, "tip")
        above = {joint.child: joint for joint in self.joints}
        joints: list[Joint] = []
        link = tip
        while link != base:
            joint = above.get(link)
            if joint is None:
                raise InvalidRobot(
                    f"{self.name}: the tip {tip!r} does not descend from the base {base!r}; "
                    f"ends below that base: {', '.join(self.leaves(base)[:40])}",
                    robot=self.name,
                    value=tip,
                    valid=self.leaves(base),
                )
            joints.append(joint)
            link = joint.parent
        return tuple(reversed(joints))

    def to_urdf(self, moving: Collection[str]) -> str:
        """Write a URDF of the bare kinematics and inertias.

        Args:
            moving: Names of the joints that move; the others are written as fixed, which locks
                them at their neutral value (zero).

        Returns:
            The document; the same tree gives the same text. Limits are placeholders, since a
            :class:`~ikplan.robots.Robot` sets its own on the model.
        """
        robot = ET.Element("robot", name=self.name)
        for link in self.links:
            element = ET.SubElement(robot, "link", name=link.name)
            if link.inertial is not None:
                _write_inertial(element, link.inertial)
        for joint in self.joints:
            moves = joint.name in moving
            kind = joint.kind if moves else "fixed"
            element = ET.SubElement(robot, "joint", name=joint.name, type=kind)
            ET.SubElement(element, "origin", xyz=_text(joint.xyz), rpy=_text(joint.rpy))
            ET.SubElement(element, "parent", link=joint.parent)
            ET.SubElement(element, "child", link=joint.child)
            if moves:
                ET.SubElement(element, "axis", xyz=_text(joint.axis))
                ET.SubElement(element, "limit", lower="0", upper="0", velocity="0", effort="0")
        return ET.tostring(robot, encoding="unicode")


def _write_inertial(link: ET.Element, inertial: Inertial) -> None:
    element = ET.SubElement(link, "inertial")
    ET.SubElement(element, "origin", xyz=_text(inertial.xyz), rpy=_text(inertial.rpy))
    ET.SubElement(element, "mass", value=repr(inertial.mass))
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    values = (repr(v) for v in inertial.inertia)
    ET.SubElement(element, "inertia", dict(zip(names, values, strict=True)))


def _text(vector: Vector) -> str:
    # Adding 0.0 turns -0.0 into 0.0, so that equal vectors give equal text.
    return " ".join(repr(v + 0.0) for v in vector)
