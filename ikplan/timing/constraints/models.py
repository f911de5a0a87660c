"""The tool's motion and the joint torques of a robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.kinematics.arm import arm_of
from ikplan.timing.constraints.tool_kernels import tool_rates
from ikplan.timing.constraints.tool_limits import ToolRates
from ikplan.timing.constraints.torque_kernels import Bodies, joint_torques
from ikplan.timing.constraints.torque_limits import InverseDynamics

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["inverse_dynamics", "tool_motion"]


def tool_motion(robot: Robot) -> ToolRates:
    """Return the velocity and acceleration of the tool for given joint motions.

    Args:
        robot: The robot, with its tool.

    Returns:
        A function of (q, dq, ddq), each (m, dof), that returns the tool frame's velocity (m, 6)
        [m/s above rad/s] and classical acceleration (m, 6) [m/s^2, rad/s^2], of its origin and in
        the base's axes.
    """
    chain = arm_of(robot).chain

    def motion(q: Array, dq: Array, ddq: Array) -> tuple[Array, Array]:
        return tool_rates(chain, *(np.ascontiguousarray(array) for array in (q, dq, ddq)))

    return motion


def inverse_dynamics(robot: Robot, payload: Any = None) -> InverseDynamics:
    """Return the joint torques that given joint motions need, gravity included.

    Args:
        robot: The robot; its model must have inertias.
        payload: A pinocchio.Inertia in the tool frame that the tool carries; None: nothing.

    Returns:
        A function of (q, dq, ddq), each (m, dof), that returns torques (m, dof) [N m or N].

    Raises:
        InvalidRequest: The robot's model has no mass.
    """
    model = robot.model
    if not sum(inertia.mass for inertia in model.inertias[1:]) > 0.0:
        raise InvalidRequest(
            "torque limits need the inertias of the robot's links, and its description has none",
            field="limits.torque",
            allowed="robots whose description gives inertias",
        )
    if payload is not None:
        model = model.copy()
        frame = model.frames[robot.tip_frame_id]
        model.appendBodyToJoint(frame.parentJoint, payload, frame.placement * robot.T_tip_tool)
    chain, bodies = arm_of(robot).chain, _bodies(robot, model)
    coupling = np.ascontiguousarray(robot.coupling, dtype=np.float64)

    def torques(q: Array, dq: Array, ddq: Array) -> Array:
        motion = (np.ascontiguousarray(array) for array in (q, dq, ddq))
        # Virtual work: the user's joints move the serial ones by the coupling.
        return np.asarray(joint_torques(chain, bodies, *motion) @ coupling)

    return torques


def _bodies(robot: Robot, model: pin.Model) -> Bodies:
    """The bodies of a model, in the frames of the robot's chain."""
    chain, R_base = arm_of(robot).chain, robot.T_universe_base.rotation
    n = model.njoints - 1
    mass, centre, inertia = np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    # The chain's frames are those of the model, turned so that joints move about or along z.
    R_before = R_base
    for i in range(n):
        turned = chain.placements[i, :9].reshape(3, 3)
        Q = model.jointPlacements[i + 1].rotation.T @ R_before @ turned
        body = model.inertias[i + 1]
        mass[i], centre[i], inertia[i] = body.mass, Q.T @ body.lever, Q.T @ body.inertia @ Q
        R_before = Q
    gravity = R_base.T @ model.gravity.linear
    return Bodies(mass, centre, inertia, np.array(model.armature, dtype=np.float64), gravity)
