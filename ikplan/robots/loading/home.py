"""A home that is not singular, for descriptions that give none.

At zero five of six real arms are stretched out or folded: their Jacobian has lost a rank, so no
straight line can begin there. Of 64 postures spread evenly over the middle 60 % of each joint's
range, the best conditioned one is taken, among those where no joint is below the base if there are
such: most arms stand on something. The postures are the points of an additive recurrence, the same
for every arm of so many joints.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.robots.description import RobotDescription
from ikplan.robots.robot import Robot

__all__ = ["conditioning", "with_good_home"]

Array = NDArray[np.float64]

_POSTURES = 64
_MIDDLE = 0.6
_SINGULAR = 1e-2
"""A smaller conditioning counts as singular."""
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
    """Build a robot, with another home if its own is singular or was not given.

    Args:
        description: The robot; its home is the one that was given, or near zero.
        given: Where its home comes from, in words; empty: it was not given.

    Raises:
        InvalidRobot: Pinocchio refuses the description.
    """
    robot = Robot(description)
    postures = _postures(robot)
    # Rounded, so that of two that are as good the first is taken on every machine.
    own, *others = np.round(conditioning(robot, np.vstack([robot.home, postures])), 9)
    if given and own >= _SINGULAR:
        return robot
    values = np.array(others)
    above = np.array([_lowest(robot, q) >= -_BELOW for q in postures]) & (values >= _SINGULAR)
    best = postures[int(np.argmax(np.where(above, values, 0.0) if above.any() else values))]
    why = f"{given} is singular" if given else "none is given"
    note = (
        f"home: the best conditioned of {_POSTURES} postures in the middle {100 * _MIDDLE:g} % of "
        f"the joints' ranges; {why}; nothing is known of what stands there"
    )
    joints = tuple(
        replace(joint, home=float(value) + 0.0)
        for joint, value in zip(description.joints, best, strict=True)
    )
    return Robot(replace(description, joints=joints, notes=(*description.notes, note)))


def _lowest(robot: Robot, q: Array) -> float:
    """Height of the lowest joint, or of the tool, over the base [m]."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(q))
    T_base_universe = robot.T_universe_base.inverse()
    joints = [float((T_base_universe * T).translation[2]) for T in list(data.oMi)[1:]]
    # Whatever lies below the base at every posture, such as its first joint, says nothing.
    return min(*joints[1:], float(robot.fk(q).translation[2])) if len(joints) > 1 else 0.0


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
