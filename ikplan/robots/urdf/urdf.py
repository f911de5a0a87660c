"""Reading and checking a URDF.

Numbers that make no sense are kept with their joint or link and are refused only where they matter:
on the chain that is planned for. What a gripper's finger says never refuses an arm.

Pinocchio accepts a zero axis, lower > upper and a zero velocity limit in silence, prints on its
own, and needs time and memory that grow with the cube of the number of joints. So a document is
read and checked here first, and Pinocchio is given only the kinematics and inertias that passed.
"""

from __future__ import annotations

import functools
import math
import xml.etree.ElementTree as ET
from collections.abc import Callable
from typing import TypeVar

from ikplan.errors import InvalidRobot
from ikplan.robots.urdf.safe_xml import read_xml
from ikplan.robots.urdf.tree import (
    MOVABLE,
    Inertial,
    Joint,
    JointLimit,
    KinematicTree,
    Link,
    Vector,
)

__all__ = ["MAX_LINKS", "MIN_AXIS_LENGTH", "parse_urdf"]

_T = TypeVar("_T")
_ORIGIN: Vector = (0.0, 0.0, 0.0)
MAX_LINKS = 1_000
MIN_AXIS_LENGTH = 1e-3
"""A shorter axis counts as zero; any other is normalised, as URDF readers do."""

_MAX_NUMBER = 1e6
_MAX_RANGE = 1e3
"""A position limit beyond it [rad] counts as none: no joint turns so far."""
_KINDS = (*MOVABLE, "fixed", "floating", "planar")
_CONVERT = {
    "mujoco": "; MJCF has no velocity limits and is not read: use the maker's URDF, or convert it",
    "sdf": "; SDF is not read: use the URDF or xacro that it was made from, or convert it",
}
"""What to do with a document of another format, by its outermost element."""


def parse_urdf(document: bytes, *, robot: str) -> KinematicTree:
    """Read a URDF into a tree of links and joints.

    Args:
        document: The bytes of the document.
        robot: Name of the robot or file, for messages.

    Returns:
        The tree, with axes of unit length. Meshes, materials, transmissions and everything else
        that kinematics does not need is ignored.

    Raises:
        InvalidRobot: The document is not XML, or not the URDF of one kinematic tree.
    """
    root = read_xml(document, robot=robot)
    if root.tag != "robot":
        hint = _CONVERT.get(root.tag, "")
        raise InvalidRobot(
            f"{robot}: not a URDF: the outermost element is <{root.tag}>, not <robot>{hint}",
            robot=robot,
            value=root.tag,
        )
    for element in root:
        if element.tag.startswith("xacro:"):
            raise InvalidRobot(
                f"{robot}: <{element.tag}> is a xacro macro; run xacro on the file first, or load "
                "the file in Python or the shell, which expand it",
                robot=robot,
                value=element.tag,
            )
    joint_elements = root.findall("joint")
    link_elements = root.findall("link")
    for what, elements in (("links", link_elements), ("joints", joint_elements)):
        if len(elements) > MAX_LINKS:
            raise InvalidRobot(
                f"{robot}: {len(elements)} {what}; at most {MAX_LINKS} are read",
                robot=robot,
                value=len(elements),
            )
    links = tuple(_link(e, robot) for e in link_elements)
    joints = tuple(_joint(e, robot) for e in joint_elements)
    return KinematicTree(robot, _root(links, joints, robot), links, joints)


def _root(links: tuple[Link, ...], joints: tuple[Joint, ...], robot: str) -> str:
    """Name of the root link of what must be one tree."""
    names = [link.name for link in links]
    for what, values in (("link", names), ("joint", [j.name for j in joints])):
        seen: set[str] = set()
        for value in values:
            if value in seen:
                raise InvalidRobot(
                    f"{robot}: two {what}s named {value!r}", robot=robot, value=value
                )
            seen.add(value)
    if not names:
        raise InvalidRobot(f"{robot}: no links", robot=robot)
    known = set(names)
    above: dict[str, Joint] = {}
    for joint in joints:
        for end, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in known:
                raise InvalidRobot(
                    f"{robot}: joint {joint.name!r} has no such {end} link: {link!r}",
                    robot=robot,
                    joint=joint.name,
                    value=link,
                    valid=names,
                )
        if joint.child in above:
            raise InvalidRobot(
                f"{robot}: link {joint.child!r} is the child of two joints, "
                f"{above[joint.child].name!r} and {joint.name!r}",
                robot=robot,
                joint=joint.name,
                value=joint.child,
            )
        above[joint.child] = joint
    roots = [name for name in names if name not in above]
    if len(roots) > 1:
        raise InvalidRobot(
            f"{robot}: not one tree: links without a parent: {', '.join(roots[:40])}",
            robot=robot,
            value=roots[1],
        )
    reached = set(roots)
    pending = list(joints)
    while pending:
        rest = [j for j in pending if j.parent not in reached]
        reached.update(j.child for j in pending if j.parent in reached)
        if len(rest) == len(pending):
            raise InvalidRobot(
                f"{robot}: joint {rest[0].name!r} is part of a loop",
                robot=robot,
                joint=rest[0].name,
            )
        pending = rest
    return roots[0]


def _link(element: ET.Element, robot: str) -> Link:
    name = _name(element, "link", robot)
    inertial = element.find("inertial")
    if inertial is None:
        return Link(name)
    try:
        return Link(name, _inertial(inertial, f"link {name!r}", robot))
    except InvalidRobot as error:
        return Link(name, fault=error.detail.removeprefix(f"{robot}: "))


def _inertial(inertial: ET.Element, where: str, robot: str) -> Inertial:
    origin = inertial.find("origin")
    mass = inertial.find("mass")
    inertia = inertial.find("inertia")
    if mass is None or inertia is None:
        raise InvalidRobot(
            f"{robot}: the inertial of {where} needs <mass> and <inertia>", robot=robot
        )
    value = _number(mass, "value", where, robot)
    if value is None or value < 0:
        raise InvalidRobot(f"{robot}: the mass of {where} is {value}", robot=robot, value=value)
    moments = [
        _number(inertia, key, where, robot) or 0.0
        for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    ]
    ixx, ixy, ixz, iyy, iyz, izz = moments
    return Inertial(
        value,
        _vector(origin, "xyz", where, robot),
        _vector(origin, "rpy", where, robot),
        (ixx, ixy, ixz, iyy, iyz, izz),
    )


def _joint(element: ET.Element, robot: str) -> Joint:
    name = _name(element, "joint", robot)
    where = f"joint {name!r}"
    kind = element.get("type") or ""
    faults: list[InvalidRobot] = []
    if kind not in _KINDS:
        faults.append(
            InvalidRobot(
                f"{robot}: {where} has the type {kind!r}; URDF knows {', '.join(_KINDS)}",
                robot=robot,
                joint=name,
                value=kind,
                valid=_KINDS,
            )
        )
        kind = "fixed"
    read = functools.partial(_or_fault, faults)
    origin = element.find("origin")
    mimic = element.find("mimic")
    axis = (0.0, 0.0, 1.0)
    if kind in MOVABLE:
        axis = read(axis, lambda: _axis(element.find("axis"), name, robot))
    return Joint(
        name=name,
        kind=kind,
        parent=_link_of(element, "parent", name, robot),
        child=_link_of(element, "child", name, robot),
        xyz=read(_ORIGIN, lambda: _vector(origin, "xyz", where, robot, joint=name)),
        rpy=read(_ORIGIN, lambda: _vector(origin, "rpy", where, robot, joint=name)),
        axis=axis,
        limit=read(JointLimit(), lambda: _limit(element.find("limit"), kind, name, robot)),
        mimic=None if mimic is None else mimic.get("joint", ""),
        multiplier=read(1.0, lambda: _mimic_number(mimic, "multiplier", 1.0, name, robot)),
        offset=read(0.0, lambda: _mimic_number(mimic, "offset", 0.0, name, robot)),
        faults=tuple(faults),
    )


def _or_fault(faults: list[InvalidRobot], neutral: _T, read: Callable[[], _T]) -> _T:
    """What is read, or a neutral value and one fault more."""
    try:
        return read()
    except InvalidRobot as error:
        faults.append(error)
        return neutral


def _mimic_number(
    mimic: ET.Element | None, key: str, absent: float, joint: str, robot: str
) -> float:
    if mimic is None:
        return absent
    value = _number(mimic, key, f"the mimic of joint {joint!r}", robot, joint=joint)
    return absent if value is None else value


def _axis(element: ET.Element | None, joint: str, robot: str) -> Vector:
    if element is None:
        return (1.0, 0.0, 0.0)  # what the URDF specification says for a missing axis
    x, y, z = _vector(element, "xyz", f"joint {joint!r}", robot, joint=joint)
    length = math.sqrt(x * x + y * y + z * z)
    if length < MIN_AXIS_LENGTH:
        raise InvalidRobot(
            f"{robot}: joint {joint!r} has a zero axis: {element.get('xyz')!r}",
            robot=robot,
            joint=joint,
            value=element.get("xyz"),
        )
    if abs(length - 1.0) < 1e-15:
        return (x, y, z)
    return (x / length, y / length, z / length)


def _limit(element: ET.Element | None, kind: str, joint: str, robot: str) -> JointLimit:
    if element is None:
        return JointLimit()
    where = f"joint {joint!r}"

    def number(key: str, most: float = _MAX_NUMBER) -> float | None:
        return _number(element, key, where, robot, joint=joint, most=most)

    # A slide without an end is no joint; a gantry of a model may be as long as numbers go.
    farthest = _MAX_NUMBER if kind == "prismatic" else _MAX_RANGE
    lower, upper, effort = (number(key, math.inf) for key in ("lower", "upper", "effort"))
    return JointLimit(
        lower=-math.inf if lower is not None and abs(lower) > farthest else lower,
        upper=math.inf if upper is not None and abs(upper) > farthest else upper,
        velocity=number("velocity"),
        effort=None if effort is not None and abs(effort) > _MAX_NUMBER else effort,
        acceleration=number("acceleration"),
    )


def _name(element: ET.Element, what: str, robot: str) -> str:
    name = element.get("name", "")
    if not name or len(name) > 200 or not name.isprintable():
        raise InvalidRobot(
            f"{robot}: a {what} has the name {name[:200]!r}; "
            "a name has 1 to 200 printable characters",
            robot=robot,
            value=name[:200],
        )
    return name


def _link_of(element: ET.Element, end: str, joint: str, robot: str) -> str:
    found = element.find(end)
    link = None if found is None else found.get("link")
    if link is None:
        raise InvalidRobot(f"{robot}: joint {joint!r} has no {end}", robot=robot, joint=joint)
    return link


def _number(
    element: ET.Element,
    key: str,
    where: str,
    robot: str,
    joint: str | None = None,
    most: float = _MAX_NUMBER,
) -> float | None:
    """The attribute as a number of a sane size, None if it is absent."""
    text = element.get(key)
    return None if text is None else _parse(text, f"{key} of {where}", robot, joint, most)


def _vector(
    element: ET.Element | None, key: str, where: str, robot: str, joint: str | None = None
) -> Vector:
    text = None if element is None else element.get(key)
    if text is None:
        return (0.0, 0.0, 0.0)
    values = [_parse(part, f"{key} of {where}", robot, joint) for part in text.split()]
    if len(values) != 3:
        raise InvalidRobot(
            f"{robot}: {key} of {where} needs three numbers: {text!r}",
            robot=robot,
            joint=joint,
            value=text,
        )
    return (values[0], values[1], values[2])


def _parse(text: str, what: str, robot: str, joint: str | None, most: float = _MAX_NUMBER) -> float:
    try:
        value = float(text)
    except ValueError as error:
        raise InvalidRobot(
            f"{robot}: {what} is not a number: {text!r}", robot=robot, joint=joint, value=text
        ) from error
    if not abs(value) <= most:  # NaN compares false
        raise InvalidRobot(
            f"{robot}: {what} is {text}; numbers must be finite and at most {_MAX_NUMBER:.0e}",
            robot=robot,
            joint=joint,
            value=text,
        )
    return value
