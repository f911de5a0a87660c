"""Where the joints of a robot are: the proof's own forward kinematics."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import leaf_kernel
from ikplan.errors import InvalidRobot
from ikplan.robots.robot import Robot

__all__ = ["JointChain", "chain_of", "place_joints"]

Array = NDArray[np.float64]


class JointChain(NamedTuple):
    """The serial joints of a robot, as arrays.

    Attributes:
        rotation: Rotation of each joint in the frame of the one before at zero, shape (n, 3, 3);
            of the first in the robot's base frame.
        position: Its origin there, shape (n, 3) [m].
        axis: Its axis of unit length in its own frame, shape (n, 3).
        slides: Whether it slides, shape (n,).
    """

    rotation: Array
    position: Array
    axis: Array
    slides: NDArray[np.bool_]


@functools.lru_cache(maxsize=128)
def chain_of(robot: Robot) -> JointChain:
    """Return the serial joints of a robot, read off its Pinocchio model.

    Robots do not change, so neither do their joints: the arrays are shared.

    Args:
        robot: The robot.

    Raises:
        InvalidRobot: A joint neither turns about nor slides along one axis, or the joints are no
            chain.
    """
    model = robot.model
    n = model.njoints - 1
    rotation, position = np.empty((n, 3, 3)), np.empty((n, 3))
    axis, slides = np.empty((n, 3)), np.zeros(n, dtype=np.bool_)
    for k in range(n):
        joint = model.joints[k + 1]
        placement = model.jointPlacements[k + 1]
        if k == 0:
            placement = robot.T_universe_base.inverse() * placement
        rotation[k], position[k] = placement.rotation, placement.translation
        data = joint.createData()
        neutral = np.zeros(joint.nq) if joint.nq == 1 else np.array([1.0, 0.0])
        screw = np.zeros(6)
        if joint.nv == 1:
            joint.calc(data, neutral)
            screw = np.asarray(data.S, dtype=np.float64).reshape(-1)
        along, about = np.linalg.norm(screw[:3]), np.linalg.norm(screw[3:])
        if joint.nv != 1 or along * about != 0.0 or model.parents[k + 1] != k:
            raise InvalidRobot(
                f"{robot.name}: joint {model.names[k + 1]} does not turn or slide about one axis "
                "after the joint before it, so that no clearance can be proven",
                robot=robot.name,
            )
        slides[k] = along > 0.0
        axis[k] = screw[:3] / along if slides[k] else screw[3:] / about
    return JointChain(rotation, position, axis, slides)


@leaf_kernel
def place_joints(chain: JointChain, q: Array, R: Array, p: Array) -> None:
    """Place the frames of all joints in the robot's base frame.

    Args:
        chain: The joints.
        q: Their serial values, shape (n,) [rad or m].
        R: Set to the rotations, shape (n + 1, 3, 3); row 0 is the base.
        p: Set to the origins, shape (n + 1, 3) [m].
    """
    for r in range(3):
        p[0, r] = 0.0
        for c in range(3):
            R[0, r, c] = 1.0 if r == c else 0.0
    for k in range(q.shape[0]):
        x, y, z = chain.axis[k, 0], chain.axis[k, 1], chain.axis[k, 2]
        fixed, offset = chain.rotation[k], chain.position[k]
        cos, sin = np.cos(q[k]), np.sin(q[k])
        for r in range(3):
            f0 = R[k, r, 0] * fixed[0, 0] + R[k, r, 1] * fixed[1, 0] + R[k, r, 2] * fixed[2, 0]
            f1 = R[k, r, 0] * fixed[0, 1] + R[k, r, 1] * fixed[1, 1] + R[k, r, 2] * fixed[2, 1]
            f2 = R[k, r, 0] * fixed[0, 2] + R[k, r, 1] * fixed[1, 2] + R[k, r, 2] * fixed[2, 2]
            p[k + 1, r] = (
                p[k, r] + R[k, r, 0] * offset[0] + R[k, r, 1] * offset[1] + R[k, r, 2] * offset[2]
            )
            if chain.slides[k]:
                p[k + 1, r] += q[k] * (f0 * x + f1 * y + f2 * z)
                R[k + 1, r, 0], R[k + 1, r, 1], R[k + 1, r, 2] = f0, f1, f2
            else:
                # A row times the rotation about the axis, by Rodrigues' formula.
                along = (1.0 - cos) * (f0 * x + f1 * y + f2 * z)
                R[k + 1, r, 0] = cos * f0 + sin * (f1 * z - f2 * y) + along * x
                R[k + 1, r, 1] = cos * f1 + sin * (f2 * x - f0 * z) + along * y
                R[k + 1, r, 2] = cos * f2 + sin * (f0 * y - f1 * x) + along * z
