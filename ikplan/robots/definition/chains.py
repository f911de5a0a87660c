"""From DH tables and joint lists to a kinematic tree."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ikplan.robots.definition.schema import AxesKinematics, DhKinematics
from ikplan.robots.urdf.tree import Joint, KinematicTree, Link, Vector

__all__ = ["axes_tree", "dh_tree"]


def dh_tree(
    name: str,
    table: DhKinematics,
    joint_names: Sequence[str],
    *,
    base: str,
    tip: str,
    radians: float,
    kinds: Sequence[str] = (),
) -> KinematicTree:
    """Tree of a DH table.

    Standard: ``A_i = Rz(theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i)``. Modified (Craig):
    ``A_i = Rx(alpha_{i-1}) Tx(a_{i-1}) Rz(theta_i) Tz(d_i)``, row i holding alpha and a of i-1.
    Each row becomes fixed frames around a joint about z, so that the tree holds the table's own
    numbers and no products of their sines.

    Args:
        name: Name of the robot.
        table: The table, lengths in m.
        joint_names: Names of the joints, one a row.
        base: Name of the base link.
        tip: Name of the link after the last row.
        radians: One unit of the table's angles [rad].
        kinds: Kind of each joint, one a row; empty: all are revolute.
    """
    builder = _Builder(base)
    kinds = kinds or ["revolute"] * len(joint_names)
    for row, joint, kind in zip(table.rows, joint_names, kinds, strict=True):
        alpha, offset = row.alpha * radians, row.theta_offset * radians
        if table.convention == "standard":
            builder.fixed(f"{joint}_zero", rpy=(0.0, 0.0, offset))
            builder.moving(joint, kind, (0.0, 0.0, 1.0))
            builder.fixed(f"{joint}_end", xyz=(row.a, 0.0, row.d), rpy=(alpha, 0.0, 0.0))
        else:
            builder.fixed(f"{joint}_row", xyz=(row.a, 0.0, 0.0), rpy=(alpha, 0.0, 0.0))
            builder.fixed(f"{joint}_zero", xyz=(0.0, 0.0, row.d), rpy=(0.0, 0.0, offset))
            builder.moving(joint, kind, (0.0, 0.0, 1.0))
    builder.fixed(tip)
    return builder.tree(name)


def axes_tree(name: str, axes: AxesKinematics, *, base: str, radians: float) -> KinematicTree:
    """Tree of a list of joint origins and axes.

    Args:
        name: Name of the robot.
        axes: The joints and the frames after the last one, lengths in m.
        base: Name of the base link.
        radians: One unit of the list's angles [rad].
    """
    builder = _Builder(base)
    for joint in axes.joints:
        x, y, z = joint.axis
        length = math.sqrt(x * x + y * y + z * z)
        axis = (x / length, y / length, z / length) if length > 0 else joint.axis
        builder.moving(joint.name, joint.type, axis, joint.xyz, _scaled(joint.rpy, radians))
    for frame, origin in axes.frames.items():
        builder.branch(frame, origin.xyz, _scaled(origin.rpy, radians))
    return builder.tree(name)


def _scaled(rpy: Vector, radians: float) -> Vector:
    return (rpy[0] * radians, rpy[1] * radians, rpy[2] * radians)


_ZERO: Vector = (0.0, 0.0, 0.0)


class _Builder:
    """Appends joints to the end of a chain; a joint's child link is named after the joint."""

    def __init__(self, base: str) -> None:
        self.root = self.end = base
        self.links = [Link(base)]
        self.joints: list[Joint] = []

    def moving(
        self, name: str, kind: str, axis: Vector, xyz: Vector = _ZERO, rpy: Vector = _ZERO
    ) -> None:
        self._append(Joint(name, kind, self.end, f"{name}_link", xyz, rpy, axis))
        self.end = f"{name}_link"

    def fixed(self, link: str, xyz: Vector = _ZERO, rpy: Vector = _ZERO) -> None:
        self.branch(link, xyz, rpy)
        self.end = link

    def branch(self, link: str, xyz: Vector, rpy: Vector) -> None:
        self._append(Joint(f"{link}_fixed", "fixed", self.end, link, xyz, rpy))

    def _append(self, joint: Joint) -> None:
        self.joints.append(joint)
        self.links.append(Link(joint.child))

    def tree(self, name: str) -> KinematicTree:
        return KinematicTree(name, self.root, tuple(self.links), tuple(self.joints))
