"""A stand-in for the xArm SDK and its controller, which runs a program and plays what it sends.

The program is run as Python, with a clock that stands still but for its sleeps. The
controller takes the last joint values that have come once a cycle, and goes there at once.
"""

from __future__ import annotations

import math
import sys
from types import ModuleType, SimpleNamespace
from unittest import mock

import numpy as np
from numpy.typing import NDArray

from benchmarks.programs.blending import Motion
from benchmarks.programs.urscript import ScriptError

__all__ = ["play"]

Array = NDArray[np.float64]
_POSITION, _SERVO = 0, 1
# The controller refuses more than this [deg/s].
_FASTEST = 180.0


class _Clock:
    def __init__(self) -> None:
        self.now = 1000.0

    def sleep(self, seconds: float) -> None:
        if seconds < 0.0:
            raise ScriptError("a sleep of negative length")
        self.now += seconds


class _Arm:
    """What of XArmAPI a program of joint values needs."""

    def __init__(self, clock: _Clock, cycle: float) -> None:
        self._clock, self._cycle = clock, cycle
        self._enabled, self._mode, self._ready = False, _POSITION, False
        self._last_sent = -math.inf
        self.points: list[list[float]] = []
        self.sent: list[tuple[float, list[float]]] = []
        self.disconnected = False

    def motion_enable(self, enable: bool) -> int:
        self._enabled = enable
        return 0

    def set_mode(self, mode: int) -> int:
        if mode not in (_POSITION, _SERVO):
            raise ScriptError(f"no such mode: {mode}")
        self._mode, self._ready = mode, False
        return 0

    def set_state(self, state: int) -> int:
        self._ready = state == 0
        return 0

    def set_servo_angle(self, *, angle: list[float], speed: float, mvacc: float, wait: bool) -> int:
        if not (self._enabled and self._ready and self._mode == _POSITION):
            return 9
        if speed > 20.0 or mvacc <= 0.0 or not wait:
            raise ScriptError("not a slow move to the first point")
        self.sent = [(self._clock.now, list(angle))]
        return 0

    def set_servo_angle_j(self, angles: list[float]) -> int:
        if not (self._enabled and self._ready and self._mode == _SERVO):
            return 9
        if self._clock.now - self._last_sent < self._cycle * (1.0 - 1e-6):
            raise ScriptError("a step before the cycle is over: the one before is lost")
        if not self.sent:
            raise ScriptError("steps before the arm is where the motion begins")
        step = max(abs(a - b) for a, b in zip(angles, self.sent[-1][1], strict=True))
        if step > _FASTEST * self._cycle:
            raise ScriptError(f"a step of {step:g} deg is faster than the arm")
        self._last_sent = self._clock.now
        self.sent.append((self._clock.now, list(angles)))
        return 0

    def disconnect(self) -> None:
        self.disconnected = True


def play(program: str, cycle: float) -> Motion:
    """Run a program.

    Args:
        program: The text.
        cycle: The controller's cycle [s].

    Raises:
        ScriptError: It does not run, or does what the arm refuses.
    """
    clock = _Clock()
    arms: list[_Arm] = []

    def connect(address: str, is_radian: bool) -> _Arm:
        if is_radian or address != "192.0.2.1":
            raise ScriptError("not the arm of this address, in degrees")
        arms.append(_Arm(clock, cycle))
        return arms[-1]

    wrapper = ModuleType("xarm.wrapper")
    wrapper.XArmAPI = connect  # type: ignore[attr-defined]
    package = ModuleType("xarm")
    package.wrapper = wrapper  # type: ignore[attr-defined]
    stopped = SimpleNamespace(sleep=clock.sleep, monotonic=lambda: clock.now)
    modules = {"xarm": package, "xarm.wrapper": wrapper, "time": stopped}
    names: dict[str, object] = {"__name__": "__main__"}
    with (
        mock.patch.dict(sys.modules, modules),
        mock.patch.object(sys, "argv", ["program", "192.0.2.1"]),
    ):
        try:
            exec(compile(program, "program", "exec"), names)
        except (SyntaxError, NameError, TypeError, ValueError, IndexError) as error:
            raise ScriptError(f"not a program: {error}") from error
        except SystemExit as error:
            raise ScriptError(f"ended: {error}") from error
    if len(arms) != 1 or not arms[0].disconnected:
        raise ScriptError("the program does not end")
    sent = arms[0].sent
    points, due = np.array(names["POINTS"], dtype=np.float64), np.array(names["TIMES"])
    begin = sent[1][0] - cycle
    time = np.array([0.0, *(when - begin for when, _ in sent[1:])])
    time[-1] = min(time[-1], float(due[-1]))
    return Motion(points, np.diff(due), time, np.array([angles for _, angles in sent]))
