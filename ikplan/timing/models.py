"""The tool's motion and the joint torques of a robot, by Pinocchio."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from ikplan.errors import InvalidRequest
from ikplan.timing.tool_limits import ToolMotion
from ikplan.timing.torque_limits import InverseDynamics

__all__ = ["PinocchioRobot", "inverse_dynamics", "tool_motion"]

Array = NDArray[np.float64]


class PinocchioRobot(Protocol):
    """A robot with a Pinocchio model of its serial joints."""

    @property
    def model(self) -> Any: ...  # noqa: D102
    @property
    def coupling(self) -> Array: ...  # noqa: D102
    @property
    def tip_frame_id(self) -> int: ...  # noqa: D102
    @property
    def T_tip_tool(self) -> Any: ...  # noqa: D102
    def configuration(self, q: ArrayLike) -> Array: ...  # noqa: D102


def _plain(robot: PinocchioRobot) -> bool:
    """Whether the joint values are Pinocchio's configuration as they are."""
    model, coupling = robot.model, robot.coupling
    square = coupling.shape[0] == coupling.shape[1] == model.nq
    return square and np.array_equal(coupling, np.eye(model.nq))


def tool_motion(robot: PinocchioRobot) -> ToolMotion:
    """Return the velocity and acceleration of the tool for given joint motions.

    Args:
        robot: The robot, with its tool.

    Returns:
        A function of (q, dq, ddq), each (m, dof), that returns the tool frame's velocity (m, 6)
        [m/s above rad/s] and classical acceleration (m, 6) [m/s^2, rad/s^2], of its origin and in
        the base's axes but for a fixed rotation, which leaves norms as they are.
    """
    model = robot.model
    data = model.createData()
    world_aligned = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    plain, coupling = _plain(robot), robot.coupling
    lever_local = np.asarray(robot.T_tip_tool.translation)

    def motion(q: Array, dq: Array, ddq: Array) -> tuple[Array, Array]:
        velocity, acceleration = np.empty((2, len(q), 6))
        levers = np.empty((len(q), 3))
        for i in range(len(q)):
            if plain:
                pin.forwardKinematics(model, data, q[i], dq[i], ddq[i])
            else:
                configuration = robot.configuration(q[i])
                pin.forwardKinematics(
                    model, data, configuration, coupling @ dq[i], coupling @ ddq[i]
                )
            tip = robot.tip_frame_id
            placement = pin.updateFramePlacement(model, data, tip)
            v = pin.getFrameVelocity(model, data, tip, world_aligned)
            a = pin.getFrameClassicalAcceleration(model, data, tip, world_aligned)
            velocity[i], acceleration[i] = v.vector, a.vector
            levers[i] = placement.rotation @ lever_local
        w, dw = velocity[:, 3:], acceleration[:, 3:]
        turning = np.cross(w, levers)
        velocity[:, :3] += turning
        acceleration[:, :3] += np.cross(dw, levers) + np.cross(w, turning)
        return velocity, acceleration

    return motion


def inverse_dynamics(robot: PinocchioRobot, payload: Any = None) -> InverseDynamics:
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
    plain, coupling = _plain(robot), robot.coupling

    def torques(q: Array, dq: Array, ddq: Array) -> Array:
        tau = np.empty_like(q)
        for i in range(len(q)):
            if plain:
                tau[i] = pin.rnea(model, data, q[i], dq[i], ddq[i])
            else:
                configuration = robot.configuration(q[i])
                serial = pin.rnea(model, data, configuration, coupling @ dq[i], coupling @ ddq[i])
                # Virtual work: the user's joints move the serial ones by the coupling.
                tau[i] = coupling.T @ serial
        return tau

    return torques
