"""The cases of E7 and E8: 100 random poses."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from ikplan.ik.objective import WEIGHTED
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.robots import Robot, load_robot

__all__ = ["MILLIMETRES", "OMEGA_R", "pose_case"]

Array = NDArray[np.float64]

OMEGA_R = 0.0384167
"""omega_R of the EOD arm with lambda_p = 0.58, per unit of ||R - R_d||_F [mm]."""
MILLIMETRES = 1000.0
"""omega_P = 1 per millimetre, per metre."""
DATA = Path(__file__).parent / "data"


@functools.cache
def _robot(name: str) -> tuple[Robot, Arm]:
    robot = load_robot(name)
    return robot, arm_of(robot)


def configurations(name: str) -> Array:
    """Return the stored random configurations of a robot, shape (100, dof) [rad]."""
    return np.loadtxt(DATA / f"{name}_poses.csv", delimiter=",", skiprows=1)


def pose_case(
    name: str, robot_name: str, title: str, omega_R: float, stop_value: float = 1e-6
) -> Case:
    """Return 100 poses of a robot with a weight of the orientation; 0: position only.

    Args:
        name: Name of the case.
        robot_name: The robot.
        title: Title of the case.
        omega_R: Weight of ||R - R_d||_F [mm].
        stop_value: A search ends at this value of the fitness [mm].
    """
    robot, arm = _robot(robot_name)
    poses = [robot.fk(q) for q in configurations(robot_name)]
    weighted = omega_R > 0.0
    return Case(
        name,
        title,
        robot,
        arm,
        np.array([pose.rotation for pose in poses]),
        np.array([pose.translation for pose in poses]),
        True,
        np.zeros(arm.dof) if robot_name == "eod_arm" else np.array(robot.home),
        kind=WEIGHTED,
        weight_position=MILLIMETRES,
        weight_orientation=omega_R if weighted else 0.0,
        tracks=False,
        stop_value=stop_value,
        reachable=np.ones(len(poses), dtype=np.bool_),
    )
