"""A home that is not singular, for descriptions that give none.

At zero five of six real arms are stretched out or folded: their Jacobian has lost a rank, so no
straight line can begin there; others stand at a joint limit. Of 64 postures spread evenly over the
middle 60 % of each joint's range, the best conditioned one with room to move is taken, or the best
of those where nothing is below the base if it is nearly as good: most arms stand on something. The
postures are the points of an additive recurrence, the same for every arm of so many joints.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.robots.description import RobotDescription
from ikplan.robots.model import frame_id
from ikplan.robots.robot import Robot

__all__ = ["conditioning", "with_good_home"]

Array = NDArray[np.float64]

_POSTURES = 64
_MIDDLE = 0.6
_SINGULAR = 1e-2
"""A smaller conditioning counts as singular."""
_AT_LIMIT = 1e-3
"""A home that can move so little, in units of the arm's size, is at a joint limit."""
_TRAVEL = 0.25
"""More room than that does not make a home better."""
_SHARE = 0.5
"""A posture above the base is taken if its conditioning is so large a share of the best one."""
_BELOW = 1e-3
"""So far below the base counts as above it [m]."""
_DIGITS = 3
"""A home is rounded to so many digits [rad or m]."""


def conditioning(robot: Robot, q: Array) -> Array:
    """Return how far postures are from singular: the least singular value of the Jacobian.

    Args:
        robot: The robot.
        q: Joint values, shape (m, dof) [rad or m].

    Returns:
        Shape (m,). Lengths count in units of the arm's size, so that arms of any size compare.
    """
    _, p = robot.poses(q)
    size = max(float(np.linalg.norm(p, axis=1).max()), 1e-6)
    jacobians = robot.jacobians(q).copy()
    jacobians[:, :3] /= size
    return np.asarray(np.linalg.svd(jacobians, compute_uv=False)[:, -1], dtype=np.float64)


def with_good_home(description: RobotDescription, given: str = "") -> Robot:
    """Build a robot, with another home if its own is singular, at a limit, or was not given.

    Args:
        description: The robot; its home is the one that was given, or near zero.
        given: Where its home comes from, in words; empty: it was not given.

    Raises:
        InvalidRobot: Pinocchio refuses the description.
    """
    robot = Robot(description)
    postures = _postures(robot)
    every = np.vstack([robot.home, postures])
    regular, free = conditioning(robot, every), _free_travel(robot, every)
    if given and regular[0] >= _SINGULAR and free[0] >= _AT_LIMIT:
        return robot
    why = f"{given} is {'singular' if regular[0] < _SINGULAR else 'at a joint limit'}"
    # Rounded, so that of two that are as good the first is taken on every machine.
    values = np.round(regular[1:] * np.minimum(free[1:] / _TRAVEL, 1.0), 9)
    T_stand_universe = _stand(robot).inverse()
    height = np.array([_lowest(robot, q, T_stand_universe) for q in postures])
    above = (height >= -_BELOW) & (values >= _SHARE * values.max())
    best = postures[int(np.argmax(np.where(above, values, -1.0) if above.any() else values))]
    note = (
        f"home: the best conditioned of {_POSTURES} postures in the middle {100 * _MIDDLE:g} % of "
        f"the joints' ranges; {why if given else 'none is given'}; what stands there is not known"
    )
    joints = tuple(
        replace(joint, home=float(value) + 0.0)
        for joint, value in zip(description.joints, best, strict=True)
    )
    return Robot(replace(description, joints=joints, notes=(*description.notes, note)))


def _free_travel(robot: Robot, q: Array) -> Array:
    """How far the tool can go before a joint is at its limit, by the Jacobian, whatever the way.

    Returns:
        Shape (m,), in units of the arm's size.
    """
    _, p = robot.poses(q)
    size = max(float(np.linalg.norm(p, axis=1).max()), 1e-6)
    left = np.minimum(q - robot.lower, robot.upper - q)
    per_metre = np.abs(np.linalg.pinv(robot.jacobians(q))[:, :, :3]).max(axis=2)
    travel = (left / np.maximum(per_metre, 1e-12)).min(axis=1) / size
    return np.asarray(np.maximum(travel, 0.0), dtype=np.float64)


def _stand(robot: Robot) -> pin.SE3:
    """Where the arm stands in the universe: the link before its first joint."""
    first = robot.model.names[1]
    for joint in ET.fromstring(robot.description.urdf).iter("joint"):  # our own writing
        parent = joint.find("parent")
        if joint.get("name") == first and parent is not None:
            link = frame_id(robot.model, parent.get("link", ""))
            return pin.SE3(robot.model.frames[link].placement)
    return robot.T_universe_base


def _lowest(robot: Robot, q: Array, T_stand_universe: pin.SE3) -> float:
    """Height of the lowest joint but the first, or of the tip, over where the arm stands [m]."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(q))
    tip = pin.updateFramePlacement(robot.model, data, robot.tip_frame_id)
    placed = [*list(data.oMi)[2:], tip]
    return min(float((T_stand_universe * T).translation[2]) for T in placed)


def _postures(robot: Robot) -> Array:
    """Postures in the middle of the ranges, shape (64, dof) [rad or m]."""
    lower = np.where(robot.prismatic, robot.lower, np.maximum(robot.lower, -np.pi))
    upper = np.where(robot.prismatic, robot.upper, np.minimum(robot.upper, np.pi))
    outside = lower >= upper  # a range beyond a turn
    lower, upper = np.where(outside, robot.lower, lower), np.where(outside, robot.upper, upper)
    # The root of x^(dof + 1) = x + 1: its powers fill a cube most evenly (Roberts, 2018).
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (robot.dof + 1))
    steps = root ** -np.arange(1.0, robot.dof + 1)
    share = np.mod(0.5 + np.arange(_POSTURES)[:, None] * steps, 1.0)
    q = 0.5 * (lower + upper) + _MIDDLE * (share - 0.5) * (upper - lower)
    rounded: Array = np.round(q, _DIGITS)
    inside: Array = np.where((rounded >= lower) & (rounded <= upper), rounded, q)
    return inside
