"""Load, or compile, the kernels before the first plan is timed."""

from __future__ import annotations

import functools
from typing import Literal

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.documents.plan_request import IkOptions, PathRequest, Waypoint
from ikplan.ik.closest_approach import explain_unreachable
from ikplan.ik.solve import PoseSolver
from ikplan.joint_path import JointPath
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.kinematics.target import pose_target
from ikplan.limits import JointLimits
from ikplan.planning import JointPathProblem, TimeBudget, plan_joint_path
from ikplan.robots import load_robot
from ikplan.timing import sample, time_joint_path

__all__ = ["warm_up", "warm_up_ik"]

Interpolation = Literal["joint", "line", "spline"]
Elongation = Literal["global", "greedy"]


@functools.cache
def warm_up(method: str = "ik-ba") -> None:
    """Make every kernel that a plan with ``method`` uses ready, once a process.

    Compiling takes tens of seconds on the first use after an installation and is no part of any
    plan's budget; loading what was compiled takes about a second.

    Args:
        method: Name of a solver.

    Raises:
        InvalidRequest: No solver of that name.
    """
    robot = load_robot("iiwa14")
    arm, limits = arm_of(robot), JointLimits.from_robot(robot)
    solver = PoseSolver(arm, method)
    q_start = np.array(robot.home)
    pose = robot.fk(q_start + 0.01)
    quaternion = pin.SE3ToXYZQUAT(pose)[3:].tolist()
    waypoints = [
        Waypoint(position=pose.translation.tolist(), quaternion_xyzw=quaternion),
        Waypoint(position=(pose.translation + 0.01).tolist()),
    ]
    kinds: list[tuple[Interpolation, Elongation]] = [
        ("joint", "greedy"),
        ("joint", "global"),
        ("line", "global"),
        ("spline", "global"),
    ]
    for interpolation, elongation in kinds:
        path = PathRequest(waypoints=waypoints, interpolation=interpolation)
        options = IkOptions(method=method, elongation=elongation)
        problem = JointPathProblem(
            robot, solver, path, options, q_start, False, limits, TimeBudget(float("inf"))
        )
        route = plan_joint_path(problem)
        joint_path = JointPath.through(route.q, limits, rest_at=route.rest)
        sample(time_joint_path(joint_path, limits), 250.0)
    _warm_up_verdict(arm, pose, q_start)


@functools.cache
def warm_up_ik(method: str) -> None:
    """Make every kernel that solves a pose with ``method`` ready, once a process.

    Args:
        method: Name of a solver.

    Raises:
        InvalidRequest: No solver of that name.
    """
    robot = load_robot("iiwa14")
    arm = arm_of(robot)
    q_start = np.array(robot.home)
    pose = robot.fk(q_start + 0.01)
    PoseSolver(arm, method).solve(pose_target(pose.translation, pose.rotation), q_start)
    _warm_up_verdict(arm, pose, q_start)


def _warm_up_verdict(arm: Arm, pose: pin.SE3, q_start: NDArray[np.float64]) -> None:
    """The verdict on a target out of reach has kernels of its own."""
    far = pose_target(pose.translation + np.array([9.0, 0.0, 0.0]), pose.rotation)
    explain_unreachable(arm, far, q_start, q_start, restarts=0)
