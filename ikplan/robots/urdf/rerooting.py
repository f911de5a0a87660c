"""Trees seen from another of their links: up one branch and down the other.

The chain from a positioner's plate to the tip of an arm goes up the positioner and down the arm. A
joint that is passed upwards is turned round: with the pose ``T M(q)`` of the child in the parent,
that of the parent in the child is ``M(q)^-1 T^-1``, a joint about the opposite axis with the same
value, and then the inverse of its origin. That inverse is written as the inverses of its factors,
``Rx(-r) Ry(-p) Rz(-y) Trans(-xyz)``, each a fixed joint, so that the tree holds the description's
own numbers and no products of their sines.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ikplan.robots.urdf.tree import Joint, KinematicTree, Link, Vector

__all__ = ["passes_upwards", "rooted_for"]


def passes_upwards(tree: KinematicTree, base: str, tip: str) -> bool:
    """Whether the way from a base to a tip goes upwards at first.

    Raises:
        InvalidRobot: No such link.
    """
    tree.require_link(base, "base")
    tree.require_link(tip, "tip")
    above = {joint.child: joint.parent for joint in tree.joints}
    link = tip
    while link != base:
        if link not in above:
            return True
        link = above[link]
    return False


def rooted_for(tree: KinematicTree, base: str, tip: str) -> KinematicTree:
    """Return a tree in which a tip descends from a base: the same, or one with the base as root.

    Args:
        tree: The tree.
        base: Base link.
        tip: Tip link.

    Raises:
        InvalidRobot: No such link.
    """
    if not passes_upwards(tree, base, tip):
        return tree
    above = {joint.child: joint for joint in tree.joints}
    upwards: list[Joint] = []
    link = base
    while link in above:
        upwards.append(above[link])
        link = above[link].parent
    turned = {joint.name for joint in upwards}
    taken = {*tree.link_names, *(joint.name for joint in tree.joints)}
    joints = [joint for joint in tree.joints if joint.name not in turned]
    links = list(tree.links)
    for joint in upwards:
        for one, new in _turned(joint, taken):
            joints.append(one)
            if new:
                links.append(Link(one.child))
                taken |= {one.name, one.child}
    return KinematicTree(tree.name, base, tuple(links), tuple(joints))


def _turned(joint: Joint, taken: set[str]) -> Iterator[tuple[Joint, bool]]:
    """Yield the joints in the place of one that is turned round, and whether their child is new."""
    x, y, z = joint.xyz
    roll, pitch, yaw = joint.rpy
    fixed: list[tuple[Vector, Vector]] = [
        ((0.0, 0.0, 0.0), (-roll, 0.0, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, -pitch, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, -yaw)),
        ((-x, -y, -z), (0.0, 0.0, 0.0)),
    ]
    fixed = [part for part in fixed if any(part[0]) or any(part[1])]
    a, b, c = joint.axis
    turned = replace(
        joint,
        parent=joint.child,
        child=joint.parent if not fixed else _free(f"{joint.name}_turned", taken),
        xyz=(0.0, 0.0, 0.0),
        rpy=(0.0, 0.0, 0.0),
        axis=(-a, -b, -c),
    )
    yield turned, bool(fixed)
    at = turned.child
    for k, (xyz, rpy) in enumerate(fixed):
        last = k == len(fixed) - 1
        child = joint.parent if last else _free(f"{joint.name}_turned_{k + 1}", taken)
        name = _free(f"{joint.name}_origin_{k + 1}", taken)
        yield Joint(name, "fixed", at, child, xyz, rpy), not last
        at = child


def _free(name: str, taken: set[str]) -> str:
    """The name, or one like it that is not taken."""
    found, k = name, 1
    while found in taken:
        k += 1
        found = f"{name}_{k}"
    return found
