"""What planning can use of an SRDF: the chain of a group, and its home."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass

from ikplan.errors import InvalidRobot
from ikplan.robots.urdf.safe_xml import read_xml
from ikplan.robots.urdf.tree import KinematicTree

__all__ = ["Group", "chain_groups", "read_allowed_pairs", "read_group"]

_HOMES = ("home", "ready")
"""Names of the state that is a home, the first that there is."""


@dataclass(frozen=True)
class Group:
    """A planning group.

    Attributes:
        name: Its name.
        base: Base link of its chain.
        tip: Tip link of its chain.
        home: Joint values of its state named "home", or else "ready" [rad or m], by joint; empty:
            there is neither.
    """

    name: str
    base: str
    tip: str
    home: dict[str, float]


def read_group(
    document: bytes, tree: KinematicTree, *, group: str | None = None, robot: str
) -> Group:
    """Read a group of an SRDF that is a chain; all else is ignored.

    Args:
        document: The bytes of the SRDF.
        tree: The URDF that it belongs to.
        group: Name of the group; None: the only one that is a chain.
        robot: Name of the robot, for messages.

    Raises:
        InvalidRobot: Not an SRDF, no such group, or a group that is no chain of the URDF.
    """
    root = _root(document, robot)
    ends = _chains(root, tree)
    if group is None and len(ends) == 1:
        group = next(iter(ends))
    if group is None or group not in ends:
        what = "name one of its groups" if group is None else f"no group {group!r} that is a chain"
        raise InvalidRobot(
            f"{robot}: SRDF: {what}; chains there: {', '.join(list(ends)[:40]) or 'none'}",
            robot=robot,
            value=group,
            valid=list(ends),
        )
    base, tip = ends[group]
    return Group(group, base, tip, _home(root, group, robot))


def chain_groups(document: bytes, tree: KinematicTree, *, robot: str) -> list[Group]:
    """Read every group of an SRDF that is a chain.

    Raises:
        InvalidRobot: Not an SRDF, or a home that is no number.
    """
    root = _root(document, robot)
    return [
        Group(name, base, tip, _home(root, name, robot))
        for name, (base, tip) in _chains(root, tree).items()
    ]


def read_allowed_pairs(document: bytes, *, robot: str) -> list[tuple[str, str, str]]:
    """Read the pairs of links that an SRDF lets touch (``disable_collisions``).

    Args:
        document: The bytes of the SRDF.
        robot: Name of the robot, for messages.

    Returns:
        Two names and the reason given, "none given" where there is none.

    Raises:
        InvalidRobot: Not an SRDF.
    """
    return [
        (
            element.get("link1", "")[:200],
            element.get("link2", "")[:200],
            element.get("reason", "")[:200] or "none given",
        )
        for element in _root(document, robot).findall("disable_collisions")
    ]


def _root(document: bytes, robot: str) -> ET.Element:
    root = read_xml(document, robot=f"{robot}: SRDF")
    if root.tag != "robot":
        raise InvalidRobot(
            f"{robot}: not an SRDF: the outermost element is <{root.tag[:200]}>, not <robot>",
            robot=robot,
            value=root.tag[:200],
        )
    return root


def _chains(root: ET.Element, tree: KinematicTree) -> dict[str, tuple[str, str]]:
    return {
        element.get("name", ""): found
        for element in root.findall("group")
        if (found := _ends(element, tree))
    }


def _ends(element: ET.Element, tree: KinematicTree) -> tuple[str, str] | None:
    """Base and tip of a group that is a chain, given as one or as its joints in order."""
    chain = element.find("chain")
    if chain is not None:
        return chain.get("base_link", ""), chain.get("tip_link", "")
    by_name = {joint.name: joint for joint in tree.joints}
    joints = [by_name[n] for j in element.findall("joint") if (n := j.get("name", "")) in by_name]
    return (joints[0].parent, joints[-1].child) if joints else None


def _home(root: ET.Element, group: str, robot: str) -> dict[str, float]:
    for home in _HOMES:
        for state in root.findall("group_state"):
            if state.get("group") == group and state.get("name", "").lower() == home:
                joints = state.findall("joint")
                return {joint.get("name", ""): _value(joint, robot) for joint in joints}
    return {}


def _value(joint: ET.Element, robot: str) -> float:
    name, text = joint.get("name", "")[:200], joint.get("value", "")[:200]
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidRobot(
            f"{robot}: SRDF: the home of joint {name!r} is {text!r}; it must be one finite number",
            robot=robot,
            joint=name,
            value=text,
        )
    return value
