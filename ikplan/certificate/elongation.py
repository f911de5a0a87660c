"""The least joint motion that given tool poses need, whatever the plan."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.robots import Robot

__all__ = ["elongation_lower_bound"]

Array = NDArray[np.float64]


def elongation_lower_bound(
    robot: Robot,
    q_start: Array | None,
    poses: Sequence[tuple[Array, Array | None]],
    errors: Sequence[tuple[float, float | None]],
) -> float:
    """Return a joint motion that no plan as exact as this one can undercut [rad or m].

    Joint i moves the tool by at most r_i per radian, r_i the length of the arm from its axis to
    the tool, and turns it by at most one radian. So by Cauchy-Schwarz a joint step of length e
    moves the tool by at most sqrt(sum r_i^2) e and turns it by at most sqrt(n) e. What the plan
    itself misses its waypoints by, it need not have moved.

    Args:
        robot: The robot, with its tool.
        q_start: Joint values at the start, shape (dof,) [rad or m]; None: at the first waypoint.
        poses: Tool position, shape (3,) [m], and rotation, shape (3, 3) (None: any), wanted at
            each waypoint in the base.
        errors: Distance [m] and rotation [rad] by which the plan misses each.
    """
    linear = math.sqrt(float((_joint_reach(robot) ** 2).sum()))
    turning = robot.coupling[~np.array([_slides(robot, k) for k in range(robot.model.nv)])]
    angular = float(np.linalg.norm(turning, 2)) * math.sqrt(len(turning)) if len(turning) else 0.0
    begin = robot.fk(q_start) if q_start is not None else None
    before = poses[0] if begin is None else (begin.translation, begin.rotation)
    missed_before = errors[0] if begin is None else (0.0, 0.0)
    total = 0.0
    for pose, missed in zip(poses, errors, strict=True):
        distance = float(np.linalg.norm(pose[0] - before[0])) - missed[0] - missed_before[0]
        step = max(distance, 0.0) / linear if linear else 0.0
        if pose[1] is not None and before[1] is not None and angular:
            angle = float(np.linalg.norm(pin.log3(before[1].T @ pose[1])))
            angle -= (missed[1] or 0.0) + (missed_before[1] or 0.0)
            step = max(step, angle / angular)
        total += step
        before, missed_before = pose, missed
    # Rounding must not lift the bound over a motion that meets it.
    return total * (1.0 - 1e-12)


def _slides(robot: Robot, joint: int) -> bool:
    """Whether serial joint ``joint`` is prismatic."""
    return "P" in robot.model.joints[joint + 1].shortname().removeprefix("JointModel")[:2]


def _joint_reach(robot: Robot) -> Array:
    """Largest tool motion per unit of each joint value, shape (dof,) [m/rad, or 1 for sliding]."""
    model = robot.model
    T_tip_tool = model.frames[robot.tip_frame_id].placement * robot.T_tip_tool
    links = [
        float(np.linalg.norm(model.jointPlacements[j].translation)) for j in range(2, model.njoints)
    ]
    links.append(float(np.linalg.norm(T_tip_tool.translation)))
    slide = np.zeros(model.nv)
    for j in range(model.nv):
        if _slides(robot, j):
            at = model.joints[j + 1].idx_q
            slide[j] = max(abs(model.lowerPositionLimit[at]), abs(model.upperPositionLimit[at]))
    reach = np.zeros(model.nv)
    for j in range(model.nv):
        reach[j] = 1.0 if _slides(robot, j) else sum(links[j:]) + sum(slide[j + 1 :])
    return np.asarray(np.abs(robot.coupling).T @ reach)
