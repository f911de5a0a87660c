"""The certificate's measures of limits, by Pinocchio.

No code of the planner or the timing is used: torques by ``pinocchio.rnea``, tool speeds and
accelerations of a frame of Pinocchio's own, jerks by finite differences.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from ikplan.arrays import Array, lengths_of
from ikplan.documents.certificate import LimitPlace
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot

__all__ = [
    "RATIO_SLACK",
    "jerk_ratios",
    "joint_torques",
    "measured_limits",
    "measured_positions",
    "tool_acceleration_ratios",
    "tool_speed_ratios",
    "torque_ratios",
]


_STILL = 1e-9
"""Velocity of a joint at rest, but for rounding [rad/s or m/s]."""
RATIO_SLACK = 1e-9
"""Rounding allowed in a ratio against a limit."""
_POSITION_ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
"""Rounding allowed in a joint value of 1 and less, more in proportion beyond [rad or m]."""


def measured_limits(
    robot: Robot, limits: MotionLimits, time: Array, q: Array, dq: Array, ddq: Array
) -> tuple[dict[str, Any], list[str]]:
    """Measure the limit ratios of a motion, those of joint positions left out.

    Args:
        robot: The robot, with its tool.
        limits: The limits.
        time: Sample times, shape (m,), m >= 1 [s].
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).

    Returns:
        Fields of the certificate, and which limits are exceeded, in words.
    """
    found: dict[str, Any] = {"jerk_limited": limits.jerk is not None}
    exceeded = []
    of_joints = {
        "velocity": np.maximum(dq / limits.velocity, dq / limits.velocity_lower),
        "acceleration": _acceleration_ratios(limits, dq, ddq),
    }
    if limits.jerk is not None:
        of_joints["jerk"] = jerk_ratios(time, ddq, limits.jerk)
    if limits.torque is not None:
        of_joints["torque"] = torque_ratios(
            robot, q, dq, ddq, limits.torque, limits.payload_mass, limits.payload_position
        )
    for kind, ratios in of_joints.items():
        ratio, place = worst_joint(robot, time, ratios)
        found[f"{kind}_limit_ratio"], found[f"{kind}_limit_at"] = ratio, place
        if not ratio <= 1.0 + RATIO_SLACK:
            exceeded.append(f"the {kind} limit of {place.joint} is exceeded at {place.time:.4f} s")
    of_tool: dict[str, Array] = {}
    if np.isfinite(limits.tool_speed).any():
        of_tool["speed"] = tool_speed_ratios(robot, q, dq, limits.tool_speed)
    if np.isfinite((*limits.tool_acceleration, limits.tool_tangential)).any():
        of_tool["acceleration"] = tool_acceleration_ratios(
            robot, q, dq, ddq, limits.tool_acceleration, limits.tool_tangential
        )
    for kind, ratios in of_tool.items():
        at = int(np.argmax(ratios))
        found[f"tool_{kind}_ratio"] = float(ratios[at])
        found[f"tool_{kind}_time"] = float(time[at])
        if not ratios[at] <= 1.0 + RATIO_SLACK:
            exceeded.append(f"the tool {kind} limit is exceeded at {time[at]:.4f} s")
    return found, exceeded


def measured_positions(robot: Robot, time: Array, q: Array) -> tuple[dict[str, Any], list[str]]:
    """Measure how near the joints come to their position limits; the arguments are as above.

    Returns:
        Fields of the certificate, and which limit is exceeded, in words.
    """
    finite = np.isfinite(robot.lower) & np.isfinite(robot.upper)
    lower, upper = np.where(finite, robot.lower, -np.inf), np.where(finite, robot.upper, np.inf)
    middle = np.zeros_like(lower)
    middle[finite] = 0.5 * (lower[finite] + upper[finite])
    half = 0.5 * (upper - lower)
    ratios = np.abs(q - middle) / half
    ratio, place = worst_joint(robot, time, ratios)
    found = {
        "position_limit_ratio": ratio,
        "position_limit_at": place if finite.any() else None,
    }
    # In a range as narrow as the rounding of joint values, that rounding is a large ratio.
    rounding = _POSITION_ROUNDING * np.maximum(1.0, np.abs(middle)) / half
    beyond = ratios - rounding
    if not beyond.max() <= 1.0 + RATIO_SLACK:
        _, place = worst_joint(robot, time, beyond)
        return found, [f"the position limit of {place.joint} is exceeded at {place.time:.4f} s"]
    return found, []


def worst_joint(robot: Robot, time: Array, ratios: Array) -> tuple[float, LimitPlace]:
    """Return the largest of ratios, shape (m, dof), with its joint and time."""
    row, joint = np.unravel_index(int(np.argmax(ratios)), ratios.shape)
    place = LimitPlace(joint=robot.joint_names[joint], time=float(time[row]))
    return float(ratios[row, joint]), place


def jerk_ratios(time: Array, ddq: Array, limit: Array) -> Array:
    """Ratios to the jerk limits between samples, by finite differences.

    Args:
        time: Sample times, shape (m,) [s].
        ddq: Joint accelerations, shape (m, dof).
        limit: Jerk limits, shape (dof,).

    Returns:
        Shape (m, dof); in row i the mean jerk from sample i to the next, in the last row 0.
    """
    ratios = np.zeros_like(ddq)
    ratios[:-1] = np.abs(np.diff(ddq, axis=0)) / np.diff(time)[:, None] / limit
    return ratios


def torque_ratios(
    robot: Robot, q: Array, dq: Array, ddq: Array, limit: Array, mass: float, centre: Array
) -> Array:
    """Ratios of the torques to their limits, gravity and payload included.

    Args:
        robot: The robot, with its tool.
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).
        limit: Torque limits, shape (dof,) [N m or N].
        mass: Mass of a payload, a point [kg].
        centre: Where it is in the tool frame, shape (3,) [m].

    Returns:
        Shape (m, dof).
    """
    tau = joint_torques(robot, q, dq, ddq, mass, centre)
    return np.asarray(np.abs(tau) / limit)


def joint_torques(
    robot: Robot, q: Array, dq: Array, ddq: Array, mass: float, centre: Array
) -> Array:
    """Torques of the joints, gravity and payload included.

    Args:
        robot: The robot, with its tool.
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).
        mass: Mass of a payload, a point [kg].
        centre: Where it is in the tool frame, shape (3,) [m].

    Returns:
        Shape (m, dof) [N m or N].
    """
    model, coupling = robot.model.copy(), robot.coupling
    if mass > 0.0:
        tip = model.frames[robot.tip_frame_id]
        centre_of_mass = (tip.placement * robot.T_tip_tool).act(centre)
        body = pin.Inertia(mass, centre_of_mass, np.zeros((3, 3)))
        model.inertias[tip.parentJoint] = model.inertias[tip.parentJoint] + body
    data = model.createData()
    motions = zip(robot.configurations(q), dq @ coupling.T, ddq @ coupling.T, strict=True)
    return np.array([pin.rnea(model, data, *motion) for motion in motions]) @ coupling


def tool_speed_ratios(robot: Robot, q: Array, dq: Array, limit: tuple[float, float]) -> Array:
    """Ratios to the tool's speed limits.

    Args:
        robot: The robot, with its tool.
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        limit: Linear and angular limit [m/s, rad/s], may be inf.

    Returns:
        The larger of both ratios, shape (m,).
    """
    model, frame = _with_tool_frame(robot)
    data = model.createData()
    velocities = np.empty((len(q), 6))
    for i, motion in enumerate(zip(robot.configurations(q), dq @ robot.coupling.T, strict=True)):
        pin.forwardKinematics(model, data, *motion)
        velocities[i] = pin.getFrameVelocity(model, data, frame, pin.ReferenceFrame.LOCAL).vector
    return _larger(velocities, limit)


def tool_acceleration_ratios(
    robot: Robot,
    q: Array,
    dq: Array,
    ddq: Array,
    limit: tuple[float, float],
    tangential: float = np.inf,
) -> Array:
    """Ratios to the tool's acceleration limits; the arguments are those of the speeds'.

    Args:
        robot: The robot, with its tool.
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).
        limit: Linear and angular limit of the norms [m/s^2, rad/s^2], may be inf.
        tangential: Limit of the rate at which the linear speed changes [m/s^2], may be inf.

    Returns:
        The largest of the linear, the angular and the tangential ratio, shape (m,).
    """
    model, frame = _with_tool_frame(robot)
    data, coupling = model.createData(), robot.coupling
    accelerations, velocities = np.empty((len(q), 6)), np.empty((len(q), 6))
    motions = zip(robot.configurations(q), dq @ coupling.T, ddq @ coupling.T, strict=True)
    for i, motion in enumerate(motions):
        pin.forwardKinematics(model, data, *motion)
        velocities[i] = pin.getFrameVelocity(model, data, frame, pin.ReferenceFrame.LOCAL).vector
        accelerations[i] = pin.getFrameClassicalAcceleration(
            model, data, frame, pin.ReferenceFrame.LOCAL
        ).vector
    v, a = velocities[:, :3], accelerations[:, :3]
    speed = lengths_of(v)
    # A tool at rest sets out, or has come to rest, along its acceleration.
    moves = speed > _STILL
    along = lengths_of(a)
    along[moves] = np.abs((v[moves] * a[moves]).sum(axis=1)) / speed[moves]
    return np.asarray(np.maximum(_larger(accelerations, limit), along / tangential))


def _with_tool_frame(robot: Robot) -> tuple[pin.Model, int]:
    """A copy of the robot's model that has the tool as a frame, and the frame's index."""
    model = robot.model.copy()
    tip = model.frames[robot.tip_frame_id]
    placement = tip.placement * robot.T_tip_tool
    tool = pin.Frame(
        "certified tool", tip.parentJoint, robot.tip_frame_id, placement, pin.FrameType.OP_FRAME
    )
    return model, model.addFrame(tool)


def _larger(twists: Array, limit: tuple[float, float]) -> Array:
    linear = lengths_of(twists[:, :3]) / limit[0]
    angular = lengths_of(twists[:, 3:]) / limit[1]
    return np.asarray(np.maximum(linear, angular))


def _acceleration_ratios(limits: MotionLimits, dq: Array, ddq: Array) -> Array:
    """Ratios of accelerations to their limits, of joints that slow down to those for that."""
    slowing = limits.deceleration
    if slowing is None:
        return np.maximum(ddq / limits.acceleration, ddq / limits.acceleration_lower)
    speeding_up = np.maximum(ddq / limits.acceleration, ddq / limits.acceleration_lower)
    slowing_down = np.abs(ddq) / slowing
    # A joint at rest begins to move, or ends: which, its velocity does not say.
    still = np.abs(dq) <= _STILL
    slows = dq * ddq < 0.0
    moving = np.where(slows, slowing_down, speeding_up)
    return np.asarray(np.where(still, np.minimum(speeding_up, slowing_down), moving))
