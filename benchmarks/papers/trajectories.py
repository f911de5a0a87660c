"""The cases of E4 to E6: four trajectories of the Motoman MH5. The coordinates are ours."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.robots import Robot, load_robot

__all__ = ["TRAJECTORIES", "convergence_case", "random_positions", "tracking_case"]

Array = NDArray[np.float64]

TRAJECTORIES = ("linear", "curvilinear", "sawtooth", "rose")
URDF_U_AXIS = np.radians([-70.0, 190.0])


@functools.cache
def _mh5() -> tuple[Robot, Arm]:
    robot = load_robot("mh5")
    return robot, arm_of(robot)


def points(name: str) -> Array:
    """Return the 17 points, shape (17, 3) [m]."""
    k = np.arange(17)
    u = k / 16.0
    y, wave = -0.25 + 0.5 * u, np.sin(math.pi * u)
    if name == "linear":
        return np.column_stack([np.full(17, 0.45), y, 0.35 + 0.2 * u])
    if name == "curvilinear":
        return np.column_stack([0.45 + 0.1 * wave, y, 0.35 + 0.15 * wave])
    if name == "sawtooth":
        return np.column_stack([np.full(17, 0.45), y, 0.35 + 0.2 * (k % 4) / 4.0])
    theta = math.pi * u
    rho = 0.15 * np.cos(3.0 * theta)
    return np.column_stack([np.full(17, 0.45), rho * np.cos(theta), 0.45 + rho * np.sin(theta)])


def tracking_case(trajectory: str, name: str, *, urdf_limits: bool = False) -> Case:
    """Return E4 of a trajectory: position only, from q = 0, each point from the one before."""
    robot, arm = _mh5()
    if urdf_limits:
        lower, upper = arm.lower.copy(), arm.upper.copy()
        lower[2], upper[2] = URDF_U_AXIS
        arm = replace(arm, lower=lower, upper=upper)
    p = points(trajectory)
    return Case(
        f"{name}-{trajectory}",
        trajectory,
        robot,
        arm,
        np.tile(np.eye(3), (len(p), 1, 1)),
        p,
        False,
        np.zeros(6),
        reachable=np.ones(len(p), dtype=np.bool_),
    )


def random_positions(name: str, count: int) -> Case:
    """Return positions of uniformly random configurations, from q = 0 each."""
    case = tracking_case("linear", name)
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence([4])))
    poses = [case.robot.fk(case.robot.random_configuration(rng)) for _ in range(count)]
    return replace(
        case,
        name=name,
        title="MH5",
        R=np.tile(np.eye(3), (count, 1, 1)),
        p=np.array([pose.translation for pose in poses]),
        tracks=False,
        reachable=np.ones(count, dtype=np.bool_),
    )


def convergence_case(trajectory: str, stop_value: float) -> Case:
    """Return E5 of a trajectory: its point 9, counted from 1."""
    case = tracking_case(trajectory, "E5")
    return replace(
        case, R=case.R[8:9], p=case.p[8:9], reachable=case.reachable[8:9], stop_value=stop_value
    )
