"""Load, or compile, the kernels before the first plan is timed."""

from __future__ import annotations

import functools

import numpy as np

from ikplan.ik.solve import PoseSolver
from ikplan.ik.verdict import explain_miss
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning import Clock, WaypointProblem, choose
from ikplan.request import IkOptions, Tolerance
from ikplan.robots import load_robot
from ikplan.timing import JointLimits, JointPath, sample, time_joint_path

__all__ = ["warm_up"]


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
    solver = PoseSolver(arm_of(robot), method)
    q_start = np.array(robot.home)
    pose = robot.fk(q_start + 0.01)
    targets = [pose_target(pose.translation, pose.rotation), pose_target(pose.translation)]
    problem = WaypointProblem(
        robot, solver, targets, q_start, False, Tolerance(), Clock(float("inf"))
    )
    for elongation in ("greedy", "global"):
        chosen = choose(problem, IkOptions(method=method, elongation=elongation))
    limits = JointLimits.from_robot(robot)
    path = JointPath.through(np.vstack([q_start, chosen.q]), limits)
    sample(time_joint_path(path, limits), 250.0)
    # The verdict on a target out of reach has kernels of its own.
    far = pose_target(pose.translation + np.array([9.0, 0.0, 0.0]), pose.rotation)
    explain_miss(arm_of(robot), far, q_start, q_start, restarts=0)
