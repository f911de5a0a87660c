"""A robot arm: kinematics from Pinocchio, limits, home, tool."""

from __future__ import annotations

import importlib
import threading
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from ikplan.robots.checks import finite_vector, positive_vector, unit_quaternion
from ikplan.robots.clearance import Clearance
from ikplan.robots.definition.assumptions import without_assumptions
from ikplan.robots.description import RobotDescription, Tool
from ikplan.robots.info import RobotInfo, robot_info
from ikplan.robots.model import build_model, coupling_arrays, frame_id

if TYPE_CHECKING:
    from ikplan.documents.scene import Scene

__all__ = ["Robot"]

Array = NDArray[np.float64]


class Robot:
    """A robot arm from its base frame to the tool frame. Immutable, thread-safe, picklable.

    Attributes:
        description: The plain data the robot is built from.
        name: Short name.
        title: Full name.
        joint_names: Names of the user's joints, from base to tip.
        dof: Number of the user's joints.
        lower: Lower position limits, shape (dof,) [rad or m], -inf for continuous joints.
        upper: Upper position limits, shape (dof,) [rad or m], inf for continuous joints.
        velocity_limit: Velocity limits, shape (dof,) [rad/s or m/s], finite and positive.
        acceleration_limit: Acceleration limits, shape (dof,) [rad/s^2 or m/s^2], the same.
        effort_limit: Effort limits, shape (dof,) [N m or N], nan where no source gives one.
        jerk_limit: Jerk limits that the maker publishes, shape (dof,) [rad/s^3 or m/s^3], or None.
        controller: The controller, or None where none is known.
        home: Home configuration, shape (dof,) [rad or m].
        continuous: Which joints turn without end, shape (dof,).
        prismatic: Which joints slide, shape (dof,).
        base_frame: Name of the base link.
        tip_frame: Name of the tip link.
        model: Pinocchio model of the serial joints; every other joint is locked at neutral.
        coupling: Serial joint values are ``coupling @ q + coupling_offset``,
            shape (n_serial, dof); the identity where the user's joints are the serial ones.
        coupling_offset: Shape (n_serial,) [rad or m].
        T_universe_base: Base frame in the model's universe.
        tip_frame_id: Frame of the tip link in the model.
        T_tip_tool: Tool frame in the tip frame.
        fingerprint: SHA-256 over all that can change a plan.
    """

    def __init__(self, description: RobotDescription) -> None:
        """Build the robot of a description.

        Raises:
            InvalidRobot: Pinocchio refuses the description.
        """
        joints = description.joints
        self.description = description
        self.name = description.name
        self.title = description.title
        self.joint_names = tuple(j.name for j in joints)
        self.dof = len(joints)
        self.lower = _frozen([j.lower for j in joints])
        self.upper = _frozen([j.upper for j in joints])
        self.velocity_limit = _frozen([j.velocity for j in joints])
        self.acceleration_limit = _frozen([j.acceleration for j in joints])
        self.effort_limit = _frozen([j.effort for j in joints])
        self.controller = description.controller
        jerk = None if self.controller is None else self.controller.jerk
        self.jerk_limit = None if jerk is None else _frozen(jerk)
        self.home = _frozen([j.home for j in joints])
        self.continuous = _frozen_flags([j.kind == "continuous" for j in joints])
        self.prismatic = _frozen_flags([j.kind == "prismatic" for j in joints])
        self.base_frame = description.base
        self.tip_frame = description.tip
        self.fingerprint = description.fingerprint()

        self.model: pin.Model = build_model(description)
        matrix, offset = coupling_arrays(description)
        self.coupling = _frozen(matrix)
        self.coupling_offset = _frozen(offset)
        base = self.model.frames[frame_id(self.model, description.base)]
        self.T_universe_base: pin.SE3 = pin.SE3(base.placement)
        self.tip_frame_id = frame_id(self.model, description.tip)
        tool = description.tool
        self.T_tip_tool: pin.SE3 = pin.XYZQUATToSE3(
            np.array([*tool.position, *tool.quaternion_xyzw])
        )

        self._T_base_universe = self.T_universe_base.inverse()
        self._tip_to_tool = self.T_tip_tool.toActionMatrixInverse()
        serial = self.model.joints[1:]
        self._bounded = np.array([j.nq == 1 for j in serial])
        self._index = np.array([j.idx_q for j in serial])
        self._identity_map = description.coupling is None and bool(self._bounded.all())
        self._local = threading.local()

    def __reduce__(self) -> tuple[type[Robot], tuple[RobotDescription]]:
        return Robot, (self.description,)

    def __repr__(self) -> str:
        return f"Robot({self.name!r}, dof={self.dof}, {self.base_frame!r} -> {self.tip_frame!r})"

    def _data(self) -> pin.Data:
        """Pinocchio's scratch space: one per thread, since every call writes to it."""
        try:
            data: pin.Data = self._local.data
        except AttributeError:
            data = self._local.data = self.model.createData()
        return data

    def configuration(self, q: ArrayLike) -> Array:
        """Pinocchio's configuration of the joint values ``q``.

        Args:
            q: Joint values, shape (dof,) [rad or m].

        Returns:
            Shape (nq,): the coupled serial joint values, with (cos, sin) for continuous joints.

        Raises:
            InvalidRequest: ``q`` has the wrong length or is not finite.
        """
        return self._configuration(finite_vector(q, self.dof, "q", self.joint_names).copy())

    def configurations(self, q: Array) -> Array:
        """Pinocchio's configurations of many joint values at once, unchecked.

        Args:
            q: Joint values, shape (m, dof) [rad or m].

        Returns:
            Shape (m, nq), as :meth:`configuration` returns them.
        """
        if self._identity_map:
            return np.ascontiguousarray(q)
        serial = q @ self.coupling.T + self.coupling_offset
        configurations = np.empty((len(q), self.model.nq))
        bounded = self._bounded
        configurations[:, self._index[bounded]] = serial[:, bounded]
        configurations[:, self._index[~bounded]] = np.cos(serial[:, ~bounded])
        configurations[:, self._index[~bounded] + 1] = np.sin(serial[:, ~bounded])
        return configurations

    def _configuration(self, q: Array) -> Array:
        if self._identity_map:
            return q
        configuration: Array = self.configurations(q[None])[0]
        return configuration

    def fk(self, q: ArrayLike) -> pin.SE3:
        """Pose of the tool frame in the base frame, T_base_tool.

        Args:
            q: Joint values, shape (dof,) [rad or m].

        Returns:
            The pose [m].

        Raises:
            InvalidRequest: ``q`` has the wrong length or is not finite.
        """
        configuration = self._configuration(finite_vector(q, self.dof, "q", self.joint_names))
        data = self._data()
        pin.forwardKinematics(self.model, data, configuration)
        T_universe_tip = pin.updateFramePlacement(self.model, data, self.tip_frame_id)
        return self._T_base_universe * T_universe_tip * self.T_tip_tool

    def jacobian(self, q: ArrayLike) -> Array:
        """Jacobian of the tool frame, expressed in the tool frame.

        Args:
            q: Joint values, shape (dof,) [rad or m].

        Returns:
            Shape (6, dof): linear velocity [m] above angular velocity [rad], per unit of joint
            velocity. With coupled joints, per unit of the user's joint velocity.

        Raises:
            InvalidRequest: ``q`` has the wrong length or is not finite.
        """
        configuration = self._configuration(finite_vector(q, self.dof, "q", self.joint_names))
        J_tip = pin.computeFrameJacobian(
            self.model, self._data(), configuration, self.tip_frame_id, pin.ReferenceFrame.LOCAL
        )
        # The binding returns the one column of a one-joint arm as a vector.
        J: Array = self._tip_to_tool @ J_tip.reshape(6, self.model.nv) @ self.coupling
        return J

    def poses(self, q: Array) -> tuple[Array, Array]:
        """Poses of the tool frame in the base frame at many joint values, unchecked.

        Args:
            q: Joint values, shape (m, dof) [rad or m].

        Returns:
            Rotations, shape (m, 3, 3), and positions, shape (m, 3) [m], as :meth:`fk` returns
            them one by one.
        """
        model, data, tip = self.model, self._data(), self.tip_frame_id
        R, p = np.empty((len(q), 3, 3)), np.empty((len(q), 3))
        T_universe_tip = data.oMf[tip]  # what is updated, seen through two arrays
        rotation, translation = T_universe_tip.rotation, T_universe_tip.translation
        for k, configuration in enumerate(self.configurations(q)):
            pin.forwardKinematics(model, data, configuration)
            pin.updateFramePlacement(model, data, tip)
            R[k], p[k] = rotation, translation
        base, tool = self._T_base_universe, self.T_tip_tool
        p += R @ tool.translation
        return base.rotation @ R @ tool.rotation, p @ base.rotation.T + base.translation

    def jacobians(self, q: Array) -> Array:
        """Jacobians of the tool frame, expressed in it, at many joint values, unchecked.

        Args:
            q: Joint values, shape (m, dof) [rad or m].

        Returns:
            Shape (m, 6, dof), as :meth:`jacobian` returns them one by one.
        """
        model, data, tip = self.model, self._data(), self.tip_frame_id
        J_tip = np.empty((len(q), 6, model.nv))
        for k, configuration in enumerate(self.configurations(q)):
            J = pin.computeFrameJacobian(model, data, configuration, tip, pin.ReferenceFrame.LOCAL)
            J_tip[k] = J.reshape(6, model.nv)
        jacobians: Array = self._tip_to_tool @ J_tip @ self.coupling
        return jacobians

    def clip(self, q: ArrayLike) -> Array:
        """The nearest joint values inside the position limits, shape (dof,) [rad or m].

        Raises:
            InvalidRequest: ``q`` has the wrong length or is not finite.
        """
        values = finite_vector(q, self.dof, "q", self.joint_names)
        return np.minimum(np.maximum(values, self.lower), self.upper)

    def random_configuration(self, rng: np.random.Generator) -> Array:
        """Joint values drawn uniformly inside the limits, shape (dof,) [rad or m].

        Continuous joints are drawn from [-pi, pi).
        """
        lower = np.where(self.continuous, -np.pi, self.lower)
        upper = np.where(self.continuous, np.pi, self.upper)
        q: Array = lower + rng.random(self.dof) * (upper - lower)
        return np.minimum(q, upper)

    def with_tool(
        self, position: ArrayLike, quaternion_xyzw: ArrayLike = (0.0, 0.0, 0.0, 1.0)
    ) -> Robot:
        """The same robot with a tool; it replaces a tool already there.

        Args:
            position: Tool frame origin in the tip frame, shape (3,) [m].
            quaternion_xyzw: Orientation of the tool frame in the tip frame, shape (4,), of unit
                length within 1e-3; it is normalised.

        Raises:
            InvalidRequest: The position or quaternion is not finite, of the wrong length, or the
                quaternion is not unit.
        """
        x, y, z = (float(v) + 0.0 for v in finite_vector(position, 3, "tool.position"))
        tool = Tool((x, y, z), unit_quaternion(quaternion_xyzw, "tool.quaternion_xyzw"))
        return Robot(replace(self.description, tool=tool))

    def with_limits(
        self, velocity: ArrayLike | None = None, acceleration: ArrayLike | None = None
    ) -> Robot:
        """The same robot with other velocity or acceleration limits.

        Args:
            velocity: Velocity limits, shape (dof,) or one for all [rad/s or m/s]; None: as they
                are.
            acceleration: Acceleration limits, the same [rad/s^2 or m/s^2].

        Raises:
            InvalidRequest: A limit is not finite and positive, or the length is wrong.
        """
        joints = self.description.joints
        sources = list(self.description.limit_sources)
        assumptions = self.description.assumptions
        for key, values in (("velocity", velocity), ("acceleration", acceleration)):
            if values is None:
                continue
            limits = positive_vector(values, self.dof, key, self.joint_names)
            joints = tuple(
                replace(j, velocity=v) if key == "velocity" else replace(j, acceleration=v)
                for j, v in zip(joints, limits.tolist(), strict=True)
            )
            sources = [
                replace(s, source="set by with_limits", default=None, verified=True)
                if s.limit == key
                else s
                for s in sources
            ]
            assumptions = without_assumptions(assumptions, key)
        return Robot(
            replace(
                self.description,
                joints=joints,
                limit_sources=tuple(sources),
                assumptions=assumptions,
            )
        )

    def clearance(self, q: ArrayLike, scene: Scene | Mapping[str, Any] | None = None) -> Clearance:
        """Least distance of the arm from itself and a scene at a configuration.

        Args:
            q: Joint values, shape (dof,) [rad or m].
            scene: A scene, as in a request; None: the arm against itself.

        Returns:
            The distance [m], negative where bodies overlap, the two bodies, and their nearest
            points. See :func:`ikplan.scene.clearance.clearance` for joints beside the chain and
            the shape of a tool.

        Raises:
            InvalidRequest: ``q`` or the scene is wrong, or there is nothing to check.
            InvalidRobot: A shape of the robot's description makes no sense.
        """
        # By name: a room above this one, which a robot does not need to be loaded.
        function = importlib.import_module("ikplan.scene.clearance").clearance
        found: Clearance = function(self, q, scene)
        return found

    def info(self) -> RobotInfo:
        """Names, limits, frames and sources, ready for JSON."""
        return robot_info(self.description, self.fingerprint)


def _frozen(values: ArrayLike) -> Array:
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def _frozen_flags(values: list[bool]) -> NDArray[np.bool_]:
    array = np.array(values, dtype=np.bool_)
    array.setflags(write=False)
    return array
