"""The limits that a motion has to keep: the robot's and the request's, merged by the strictest."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.documents.limits import LEAST, LimitOptions, SegmentLimits, ToolAcceleration, ToolRate
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot
from ikplan.robots.definition.assumptions import is_assumed

__all__ = ["STILL", "LimitedSegment", "MotionLimits"]


STILL = 0.5 * LEAST
"""What 0 stands for: less than can be asked for. A joint of this limit must not move, which the
timing sees to; one that stands still keeps any limit."""


@dataclass(frozen=True, eq=False)
class MotionLimits:
    """Numbers only: what timing is given and what the certificate checks.

    Attributes:
        velocity: Highest joint velocities, shape (dof,) [rad/s or m/s].
        velocity_lower: Lowest joint velocities, shape (dof,), negative.
        acceleration: Highest joint accelerations, shape (dof,) [rad/s^2 or m/s^2].
        acceleration_lower: Lowest joint accelerations, shape (dof,), negative.
        deceleration: Highest rates of slowing down, shape (dof,); None: the accelerations hold for
            slowing down too, else for speeding up only.
        jerk: Highest joint jerks, shape (dof,) [rad/s^3 or m/s^3]; None: no limit.
        torque: Highest joint torques, shape (dof,) [N m or N]; None: no limit.
        payload_mass: Mass that the tool carries [kg].
        payload_position: Its centre in the tool frame, shape (3,) [m].
        tool_speed: Linear and angular speed of the tool [m/s, rad/s]; inf: no limit.
        tool_acceleration: Linear and angular acceleration [m/s^2, rad/s^2]; inf: no limit.
        tool_tangential: Rate at which the tool's linear speed changes [m/s^2]; inf: no limit.
        jerk_source: Who gave the jerk limits: "request" (the maker's hold too) or "controller";
            None: there are none.
    """

    velocity: Array
    velocity_lower: Array
    acceleration: Array
    acceleration_lower: Array
    jerk: Array | None
    torque: Array | None
    payload_mass: float
    payload_position: Array
    tool_speed: tuple[float, float]
    tool_acceleration: tuple[float, float]
    jerk_source: str | None = None
    deceleration: Array | None = None
    tool_tangential: float = np.inf

    @property
    def of_loads_or_tool(self) -> bool:
        """Whether torques or the motion of the tool are limited."""
        tool = (*self.tool_speed, *self.tool_acceleration, self.tool_tangential)
        return self.torque is not None or bool(np.isfinite(tool).any())

    @property
    def largest_acceleration(self) -> Array:
        """Largest acceleration of each joint, whichever way and whether it speeds up, (dof,)."""
        most = np.maximum(self.acceleration, -self.acceleration_lower)
        return most if self.deceleration is None else np.maximum(most, self.deceleration)

    @classmethod
    def of(cls, robot: Robot, options: LimitOptions) -> MotionLimits:
        """Merge a robot's limits with those of a request.

        Args:
            robot: The robot, with its tool.
            options: The limits asked for.

        Returns:
            The strictest of both.

        Raises:
            InvalidRequest: A list has the wrong length; a torque limit is asked of a robot whose
                inertias or torque limits have no source; a payload without a torque limit.
        """
        own_jerk = None if options.jerk is False else robot.jerk_limit
        # A default that no source gives holds where nothing is asked for: see _own.
        firm = np.where(_assumed(robot), np.inf, robot.acceleration_limit)
        return cls(
            velocity=robot.velocity_limit,
            velocity_lower=-robot.velocity_limit,
            acceleration=firm,
            acceleration_lower=-firm,
            jerk=own_jerk,
            torque=None,
            payload_mass=0.0,
            payload_position=np.zeros(3),
            tool_speed=(np.inf, np.inf),
            tool_acceleration=(np.inf, np.inf),
            jerk_source=None if own_jerk is None else "controller",
        ).within(robot, options, "limits")

    def within(
        self, robot: Robot, options: SegmentLimits | LimitOptions, field: str
    ) -> MotionLimits:
        """Merge these limits with more.

        Args:
            robot: The robot, with its tool.
            options: The limits asked for; scales are of the robot's own limits.
            field: What the request calls them.

        Returns:
            The strictest of both.

        Raises:
            InvalidRequest: As by :meth:`of`.
        """
        up, down = _rates(robot, options, "velocity", options.velocity_scale, field)
        a_up, a_down = _rates(robot, options, "acceleration", options.acceleration_scale, field)
        torque = self.torque
        if options.torque is not False:
            asked = _torque(robot, options.torque, f"{field}.torque")
            torque = asked if torque is None else np.minimum(torque, asked)
        mass, centre = self.payload_mass, self.payload_position
        if options.payload is not None:
            if torque is None:
                raise InvalidRequest(
                    f"{field}.payload: a payload counts only towards torques; set {field}.torque "
                    "too",
                    field=f"{field}.payload",
                    allowed=f"null, or {field}.torque with it",
                )
            mass, centre = options.payload.mass, np.array(options.payload.position)
        jerk, jerk_source = self.jerk, self.jerk_source
        if options.jerk is not None and options.jerk is not False:
            jerk_source = "request"
            asked = _each(robot, options.jerk, f"{field}.jerk")
            jerk = asked if jerk is None else np.minimum(jerk, asked)
        return replace(
            self,
            velocity=np.minimum(self.velocity, up),
            velocity_lower=np.maximum(self.velocity_lower, down),
            acceleration=np.minimum(self.acceleration, a_up),
            acceleration_lower=np.maximum(self.acceleration_lower, a_down),
            deceleration=self._slowing_down(robot, options, a_up, a_down, field),
            jerk=jerk,
            torque=torque,
            payload_mass=mass,
            payload_position=centre,
            tool_speed=_stricter(self.tool_speed, _tool(options.tool_speed)),
            tool_acceleration=_stricter(self.tool_acceleration, _tool(options.tool_acceleration)),
            tool_tangential=min(self.tool_tangential, _tangential(options.tool_acceleration)),
            jerk_source=jerk_source,
        )

    def _slowing_down(
        self,
        robot: Robot,
        options: SegmentLimits | LimitOptions,
        up: Array,
        down: Array,
        field: str,
    ) -> Array | None:
        """Merge how fast joints may slow down; None: as fast as they may speed up."""
        given = options.deceleration
        if given is None and self.deceleration is None:
            return None
        known = self.deceleration
        if known is None:
            known = np.minimum(self.acceleration, -self.acceleration_lower)
        if given is None:
            return np.minimum(known, np.minimum(up, -down))
        asked = _each(robot, given, f"{field}.deceleration")
        own = options.acceleration_scale * _own(robot, "acceleration", asked)
        return np.minimum(known, np.minimum(own, asked))


@dataclass(frozen=True, eq=False)
class LimitedSegment:
    """A segment of a joint path with limits of its own.

    Attributes:
        field: What of the request asks for them.
        first: Index of the joint path's waypoint at which it begins.
        last: Index of the one at which it ends.
        limits: All that the motion has to keep there.
    """

    field: str
    first: int
    last: int
    limits: MotionLimits


def _each(robot: Robot, value: float | list[float], field: str) -> Array:
    """One value for each joint, shape (dof,)."""
    if isinstance(value, list) and len(value) != robot.dof:
        raise InvalidRequest(
            f"{field}: {robot.dof} values expected ({', '.join(robot.joint_names)}), "
            f"got {len(value)}",
            field=field,
            allowed=f"{robot.dof} numbers",
        )
    each = np.broadcast_to(np.array(value, dtype=np.float64), (robot.dof,))
    return np.where(each == 0.0, STILL, each)


def _rates(
    robot: Robot, options: SegmentLimits | LimitOptions, kind: str, scale: float, field: str
) -> tuple[Array, Array]:
    """Highest and lowest velocities or accelerations."""
    above, below = getattr(options, kind), getattr(options, f"{kind}_lower")
    if above is None:
        up: Array = scale * _own(robot, kind, None)
    else:
        asked = _each(robot, above, f"{field}.{kind}")
        up = np.minimum(scale * _own(robot, kind, asked), asked)
    if below is None:
        return up, -up
    asked = _each(robot, below, f"{field}.{kind}_lower")
    return up, np.maximum(-scale * _own(robot, kind, -asked), asked)


@functools.lru_cache(maxsize=128)
def _assumed(robot: Robot) -> Flags:
    """Which joints' acceleration limits are only a default that no source gives, shape (dof,)."""
    said = robot.description.assumptions
    found = np.array([is_assumed(said, "acceleration", n) for n in robot.joint_names], dtype=bool)
    found.setflags(write=False)
    return found


def _own(robot: Robot, kind: str, asked: Array | None) -> Array:
    """The robot's own limits, shape (dof,); what is asked for in place of a lower default."""
    own: Array = getattr(robot, f"{kind}_limit")
    if asked is None or kind != "acceleration":
        return own
    return np.where(_assumed(robot), np.maximum(own, asked), own)


def _torque(robot: Robot, asked: bool | list[float], field: str) -> Array:
    """Highest torques of the joints."""
    info = robot.info()
    if not info.inertias_sourced:
        raise InvalidRequest(
            f"{field}: {robot.name} has no sourced inertias, so its torques cannot be known"
            + "".join(f" ({note})" for note in info.notes if note.startswith("torques ")),
            field=field,
            allowed="robots whose description gives the inertias of every link; or false",
        )
    effort = robot.effort_limit
    if isinstance(asked, list):
        # A joint whose torque limit is not known has the one asked for.
        return np.fmin(effort, _each(robot, asked, field))
    unknown = [n for n, e in zip(robot.joint_names, effort, strict=True) if not e > 0.0]
    if unknown:
        raise InvalidRequest(
            f"{field}: no torque limit is known for {', '.join(unknown)} of {robot.name}; "
            "give one for each joint",
            field=field,
            allowed=f"{robot.dof} numbers",
        )
    return effort


def _stricter(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    return (min(one[0], other[0]), min(one[1], other[1]))


def _tangential(limit: Any) -> float:
    """Tangential limit; inf where there is none."""
    asked = limit.tangential if isinstance(limit, ToolAcceleration) else None
    return np.inf if asked is None else float(asked)


def _tool(limit: Any) -> tuple[float, float]:
    """Linear and angular limit; inf where there is none."""
    if limit is None:
        return (np.inf, np.inf)
    if not isinstance(limit, ToolRate):
        return (float(limit), np.inf)
    linear, angular = (np.inf if v is None else v for v in (limit.linear, limit.angular))
    return (linear, angular)
