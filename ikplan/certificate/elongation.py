"""The least joint motion that given tool poses need, whatever the plan."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from ikplan.arrays import Array, length_of
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedWaypoint
from ikplan.certificate.waypoints import Misses
from ikplan.robots import Robot

__all__ = ["elongation_lower_bound", "joint_reach"]

_Pose = tuple[Array, Array | None]
"""Position, shape (3,) [m], and rotation, shape (3, 3), of the tool; None: free."""


def elongation_lower_bound(
    robot: Robot,
    q_start: Array | None,
    waypoints: Sequence[RequestedWaypoint],
    allowance: Allowance,
    misses: Misses,
) -> float:
    """Return a joint motion that no plan as exact as this one can undercut [rad or m].

    Joint i moves the tool by at most r_i per radian, r_i the length of the arm from its axis to
    the tool, and turns it by at most one radian. So by Cauchy-Schwarz a joint step of length e
    moves the tool by at most sqrt(sum r_i^2) e and turns it by at most sqrt(n) e. What the request
    leaves free, and what the plan itself misses its waypoints by, it need not have moved.

    Args:
        robot: The robot, with its tool.
        q_start: Joint values at the start, shape (dof,) [rad or m]; None: at the first waypoint.
        waypoints: The waypoints.
        allowance: What is allowed at them.
        misses: What the plan misses each by.
    """
    linear, angular = _tool_rates(robot)
    near = misses.distance + float(np.linalg.norm(allowance.box_position))
    like = misses.angle + float(np.linalg.norm(allowance.box_orientation)) + allowance.cone
    # Of several targets any may be gone to: the least over all ways to choose.
    rows = [[(w.p, w.R) for w in (waypoint, *waypoint.others)] for waypoint in waypoints]
    if q_start is not None:
        begin = robot.fk(q_start)
        rows.insert(0, [(begin.translation, begin.rotation)])
        near, like = np.concatenate([[0.0], near]), np.concatenate([[0.0], like])
    total = [0.0] * len(rows[0])
    for k in range(1, len(rows)):

        def step(before: _Pose, after: _Pose, k: int = k) -> float:
            distance = length_of(after[0] - before[0]) - near[k] - near[k - 1]
            least = max(distance, 0.0) / linear if linear else 0.0
            if before[1] is None or after[1] is None or not angular or allowance.positions_only:
                return float(least)
            angle = _turn(before[1], after[1], allowance.free_axis) - like[k] - like[k - 1]
            return float(max(least, angle / angular))

        if len(rows[k]) == len(total) == 1:
            total[0] += step(rows[k - 1][0], rows[k][0])
            continue
        total = [
            min(sum_before + step(a, b) for sum_before, a in zip(total, rows[k - 1], strict=True))
            for b in rows[k]
        ]
    # Rounding must not lift the bound over a motion that meets it.
    return min(total) * (1.0 - 1e-12)


@functools.lru_cache(maxsize=128)
def _tool_rates(robot: Robot) -> tuple[float, float]:
    """How far and how much the tool moves and turns per unit of joint motion, at most.

    Robots do not change, so neither do these.
    """
    linear = math.sqrt(float((joint_reach(robot) ** 2).sum()))
    turning = robot.coupling[~np.array([_slides(robot, k) for k in range(robot.model.nv)])]
    angular = float(np.linalg.norm(turning, 2)) * math.sqrt(len(turning)) if len(turning) else 0.0
    return linear, angular


def _turn(before: Array, after: Array, free_axis: int | None) -> float:
    """Angle between two orientations, or between the directions of their free axes [rad]."""
    if free_axis is None:
        return length_of(pin.log3(before.T @ after))
    a, b = before[:, free_axis], after[:, free_axis]
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def _slides(robot: Robot, joint: int) -> bool:
    """Whether serial joint ``joint`` is prismatic."""
    return "P" in robot.model.joints[joint + 1].shortname().removeprefix("JointModel")[:2]


@functools.lru_cache(maxsize=128)
def joint_reach(robot: Robot) -> Array:
    """Return the largest tool motion per unit of each joint value, shape (dof,) [m/rad, m/m].

    The array is shared, and read-only.
    """
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
    found = np.asarray(np.abs(robot.coupling).T @ reach)
    found.setflags(write=False)
    return found
