"""Where the bodies of a model are at a configuration."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from ikplan.robots import Robot

__all__ = ["carrier_poses"]

Array = NDArray[np.float64]


def carrier_poses(robot: Robot, q: ArrayLike) -> tuple[Array, Array]:
    """Poses of the carriers of bodies in the robot's base frame.

    Args:
        robot: The robot.
        q: Joint values, shape (dof,) [rad or m].

    Returns:
        Rotations, shape (n_serial + 1, 3, 3), and positions, shape (n_serial + 1, 3) [m]; the
        first is the base itself, row k the frame of serial joint k.

    Raises:
        InvalidRequest: ``q`` has the wrong length or is not finite.
    """
    configuration = robot.configuration(q)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, configuration)
    T_base = robot.T_universe_base.inverse()
    placed = [T_base * data.oMi[k] for k in range(1, robot.model.njoints)]
    R = np.array([np.eye(3), *(T.rotation for T in placed)])
    p = np.array([np.zeros(3), *(T.translation for T in placed)])
    return R, p
