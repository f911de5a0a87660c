"""The tool's motion and the joint torques of a robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest
from ikplan.kinematics.arm import arm_of
from ikplan.timing.tool_kernels import tool_rates
from ikplan.timing.tool_limits import ToolMotion
from ikplan.timing.torque_limits import InverseDynamics

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["inverse_dynamics", "tool_motion"]

Array = NDArray[np.float64]


def tool_motion(robot: Robot) -> ToolMotion:
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
    data = model.createData()
    coupling = robot.coupling
    plain = np.array_equal(coupling, np.eye(*coupling.shape))

    def torques(q: Array, dq: Array, ddq: Array) -> Array:
        configurations = robot.configurations(q)
        if not plain:
            dq, ddq = dq @ coupling.T, ddq @ coupling.T
        serial = np.empty_like(dq)
        for i, motion in enumerate(zip(configurations, dq, ddq, strict=True)):
            serial[i] = pin.rnea(model, data, *motion)
        # Virtual work: the user's joints move the serial ones by the coupling.
        return serial if plain else np.asarray(serial @ coupling)

    return torques
