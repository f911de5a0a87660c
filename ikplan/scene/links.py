"""Where the links of a robot stand: which joint carries each, and at which pose."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest, near_names
from ikplan.robots import Robot
from ikplan.robots.urdf.rerooting import rooted_for
from ikplan.robots.urdf.tree import MOVABLE, Joint, KinematicTree, Vector
from ikplan.robots.urdf.urdf import parse_urdf

__all__ = ["Links", "links_of", "rotation_rpy", "tree_poses"]

Array = NDArray[np.float64]
Pose = tuple[Array, Array]
"""Rotation, shape (3, 3), and origin, shape (3,) [m]."""

_IDENTITY: Pose = (np.eye(3), np.zeros(3))


class Links(NamedTuple):
    """The links of a robot at given values of the joints beside its chain.

    Attributes:
        carrier: What each link moves with, by name: 0 for the base, k for serial joint k.
        pose: Pose of each link in the frame of its carrier, by name.
        parent: The link above each, by name.
        loose: Links that follow a joint of the chain in a way that the model does not have.
        fixed: Values of the joints beside the chain, by name [rad or m].
    """

    carrier: dict[str, int]
    pose: dict[str, Pose]
    parent: dict[str, str]
    loose: frozenset[str]
    fixed: dict[str, float]


def links_of(robot: Robot, fixed_joints: Mapping[str, float] | None = None) -> Links:
    """Say where the links of a robot stand.

    Args:
        robot: The robot.
        fixed_joints: Values of joints beside the chain [rad or m]; the others as the robot's
            description has them, else at zero.

    Raises:
        InvalidRequest: No such joint beside the chain, or a value outside its limits.
    """
    source = robot.description.shapes
    document = source.urdf or robot.description.urdf.encode()
    tree = rooted_for(parse_urdf(document, robot=robot.name), robot.base_frame, robot.tip_frame)
    serial = {name: k for k, name in enumerate(robot.model.names) if k}
    fixed = _fixed_values(robot, tree, serial, fixed_joints or {})
    carrier, pose, parent = {tree.root: 0}, tree_poses(tree, fixed, serial), dict[str, str]()
    loose: set[str] = set()
    for joint in _downwards(tree):
        above, link = joint.parent, joint.child
        parent[link] = above
        carrier[link] = serial.get(joint.name, carrier[above])
        follows = joint.mimic is not None and joint.mimic in serial
        if follows or (above in loose and joint.name not in serial):
            loose.add(link)
    base = pose[robot.base_frame]
    R, p = base[0].T, -base[0].T @ base[1]
    for link, number in carrier.items():
        if number == 0:
            pose[link] = _product((R, p), pose[link])
    return Links(carrier, pose, parent, frozenset(loose), fixed)


def tree_poses(
    tree: KinematicTree, values: Mapping[str, float] | None = None, frames: Collection[str] = ()
) -> dict[str, Pose]:
    """Poses of the links of a tree.

    Args:
        tree: The tree.
        values: Values of its joints by name [rad or m]; those not named stand at zero.
        frames: Joints whose frame the links behind them are given in.

    Returns:
        The pose of each link, by name: in the frame of the last of those joints before it, else
        of the root.
    """
    pose = {tree.root: _IDENTITY}
    for joint in _downwards(tree):
        if joint.name in frames:
            pose[joint.child] = _IDENTITY
            continue
        origin = (rotation_rpy(joint.rpy), np.array(joint.xyz))
        placed = _product(pose[joint.parent], origin)
        pose[joint.child] = _product(placed, _moved(joint, (values or {}).get(joint.name, 0.0)))
    return pose


def rotation_rpy(rpy: Vector) -> Array:
    """Rotation of fixed-axis roll, pitch and yaw [rad], shape (3, 3)."""
    a, b, c = (math.cos(x) for x in rpy)
    d, e, f = (math.sin(x) for x in rpy)
    return np.array(
        [
            [c * b, c * e * d - f * a, c * e * a + f * d],
            [f * b, f * e * d + c * a, f * e * a - c * d],
            [-e, b * d, b * a],
        ]
    )


def _downwards(tree: KinematicTree) -> list[Joint]:
    """Every joint after the one above it."""
    below: dict[str, list[Joint]] = {}
    for joint in tree.joints:
        below.setdefault(joint.parent, []).append(joint)
    ordered: list[Joint] = []
    pending = [tree.root]
    while pending:
        link = pending.pop()
        for joint in below.get(link, []):
            ordered.append(joint)
            pending.append(joint.child)
    return ordered


def _fixed_values(
    robot: Robot, tree: KinematicTree, serial: Mapping[str, int], given: Mapping[str, float]
) -> dict[str, float]:
    """Values of the joints beside the chain, those that follow another one included."""
    free = {
        joint.name: joint
        for joint in tree.joints
        if joint.kind in MOVABLE and joint.name not in serial and joint.mimic is None
    }
    for name, value in given.items():
        field = f"fixed_joints.{name}"
        if name not in free:
            near = near_names(name, free)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            why = "is on the chain" if name in serial else "is no joint beside the chain"
            raise InvalidRequest(
                f"{field}: {name!r} {why} of {robot.name}{hint}; there are: "
                + (", ".join(free) or "none"),
                field=field,
                allowed=list(free),
            )
        limit = free[name].limit
        low = -math.inf if limit.lower is None else limit.lower
        high = math.inf if limit.upper is None else limit.upper
        if free[name].kind != "continuous" and not low <= value <= high:
            raise InvalidRequest(
                f"{field}: {value:g} is outside the limits of the joint, {low:g} to {high:g}",
                field=field,
                allowed=f"{low:g} to {high:g}",
            )
    own = dict(robot.description.shapes.fixed_joints)
    values = {name: float(given.get(name, own.get(name, 0.0))) for name in free}
    for joint in tree.joints:
        if joint.mimic in values:
            values[joint.name] = joint.multiplier * values[joint.mimic] + joint.offset
    return values


def _moved(joint: Joint, value: float) -> Pose:
    """What a joint beside the chain does at a value."""
    axis = np.array(joint.axis)
    if joint.kind == "prismatic":
        return np.eye(3), value * axis
    if joint.kind not in MOVABLE:
        return _IDENTITY
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(value) * K + (1.0 - math.cos(value)) * (K @ K), np.zeros(3)


def _product(a: Pose, b: Pose) -> Pose:
    return a[0] @ b[0], a[0] @ b[1] + a[1]
