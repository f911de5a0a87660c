"""A stand-in for franky and the arm behind it, which runs a program and plays what it commands.

The program is run as Python. Moves are made by Ruckig at 1 kHz: one waypoint after the other, the
next one in the cycle after the one before is reached; the last one is held for 10 ms.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any
from unittest import mock

import numpy as np
import ruckig
from numpy.typing import NDArray

from benchmarks.programs.urscript import ScriptError

__all__ = ["Commanded", "play"]

Array = NDArray[np.float64]
_JOINTS = 7
_CYCLE = 0.001
_COOLDOWN = 10


@dataclass
class Commanded:
    """What the arm is told.

    Attributes:
        points: Waypoints, the first one where the motion begins, shape (n, 7) [rad].
        q: Joint values once a cycle, shape (m, 7) [rad].
        reached: Cycles until the last waypoint is reached.
    """

    points: Array
    q: Array
    reached: int


@dataclass
class _State:
    q: Sequence[float]
    dq: Sequence[float] = field(default_factory=lambda: [0.0] * _JOINTS)


@dataclass
class _Waypoint:
    target: _State
    minimum_time: int | None = None


class _Limit:
    def __init__(self, most: Sequence[float]) -> None:
        self.value, self._most = list(most), list(most)

    def set(self, values: Sequence[float]) -> None:
        if len(values) != _JOINTS or any(
            not 0.0 < v <= m for v, m in zip(values, self._most, strict=True)
        ):
            raise ScriptError("a limit above the maker's")
        self.value = list(values)


class _Robot:
    """What of a franky robot a program of waypoints needs."""

    def __init__(self, limits: Array) -> None:
        velocity, acceleration, jerk = limits.tolist()
        self.joint_velocity_limit = _Limit(velocity)
        self.joint_acceleration_limit = _Limit(acceleration)
        self.joint_jerk_limit = _Limit(jerk)
        self.relative_dynamics_factor = 1.0
        self.rows: list[list[float]] = []
        self.points: list[list[float]] = []
        self.reached = 0

    def move(self, motion: Any) -> None:
        waypoints: list[_Waypoint] = motion.waypoints
        if not self.points:
            if len(waypoints) != 1 or any(waypoints[0].target.dq):
                raise ScriptError("the motion begins before the arm is there")
            if self.relative_dynamics_factor > 0.1:
                raise ScriptError("not a slow move to the first waypoint")
            self.points = [list(waypoints[0].target.q)]
            self.rows = [list(waypoints[0].target.q)]
            return
        if self.relative_dynamics_factor != 1.0 or len(self.points) > 1:
            raise ScriptError("not one motion at the speed of the plan")
        if any(waypoints[-1].target.dq):
            raise ScriptError("the motion does not end at rest")
        self._follow(waypoints)

    def _follow(self, waypoints: list[_Waypoint]) -> None:
        otg = ruckig.Ruckig(_JOINTS, _CYCLE)
        ask: Any = ruckig.InputParameter(_JOINTS)
        out: Any = ruckig.OutputParameter(_JOINTS)
        ask.current_position = self.rows[-1]
        ask.current_velocity = ask.current_acceleration = [0.0] * _JOINTS
        ask.max_velocity = self.joint_velocity_limit.value
        ask.max_acceleration = self.joint_acceleration_limit.value
        ask.max_jerk = self.joint_jerk_limit.value
        for waypoint in waypoints:
            self.points.append(list(waypoint.target.q))
            ask.target_position, ask.target_velocity = waypoint.target.q, waypoint.target.dq
            ask.target_acceleration = [0.0] * _JOINTS
            ask.minimum_duration = None
            if waypoint.minimum_time is not None:
                ask.minimum_duration = waypoint.minimum_time / 1000.0
            result = ruckig.Result.Working
            while result == ruckig.Result.Working:
                result = otg.update(ask, out)
                if result not in (ruckig.Result.Working, ruckig.Result.Finished):
                    raise ScriptError(f"no move to a waypoint: {result}")
                self.rows.append(list(out.new_position))
                out.pass_to_input(ask)
        self.reached = len(self.rows) - 1
        self.rows += [self.rows[-1]] * _COOLDOWN


def play(program: str, limits: Array) -> Commanded:
    """Run a program.

    Args:
        program: The text.
        limits: The maker's joint velocities, accelerations and jerks, shape (3, 7).

    Raises:
        ScriptError: It does not run, or does what the arm refuses.
    """
    robots: list[_Robot] = []

    def connect(address: str) -> _Robot:
        if address != "192.0.2.1":
            raise ScriptError("not the arm of this address")
        robots.append(_Robot(limits))
        return robots[-1]

    def duration(milliseconds: int) -> int:
        if not isinstance(milliseconds, int) or milliseconds < 1:
            raise ScriptError(f"not a duration of whole milliseconds: {milliseconds}")
        return milliseconds

    class Motion:
        def __init__(self, waypoints: list[_Waypoint]) -> None:
            self.waypoints = waypoints

    module = ModuleType("franky")
    module.__dict__.update(
        Duration=duration,
        JointMotion=lambda q: Motion([_Waypoint(_State(q))]),
        JointState=_State,
        JointWaypoint=_Waypoint,
        JointWaypointMotion=Motion,
        Robot=connect,
    )
    with (
        mock.patch.dict(sys.modules, {"franky": module}),
        mock.patch.object(sys, "argv", ["program", "192.0.2.1"]),
    ):
        try:
            exec(compile(program, "program", "exec"), {"__name__": "__main__"})
        except (SyntaxError, NameError, TypeError, ValueError, ImportError) as error:
            raise ScriptError(f"not a program: {error}") from error
    if len(robots) != 1 or len(robots[0].points) < 2:
        raise ScriptError("the program moves nothing")
    robot = robots[0]
    return Commanded(np.array(robot.points), np.array(robot.rows), robot.reached)
