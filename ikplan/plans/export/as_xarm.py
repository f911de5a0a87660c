"""A plan as a Python program that streams joint values by the xArm SDK, for UFACTORY arms.

The SDK has no moves of a given time: ``set_servo_angle`` has speeds, and its ``mvtime`` is
reserved. In servo mode ``set_servo_angle_j`` takes one set of joint values a cycle and goes there
at once (xArm Python SDK 1.18, ``set_servo_angle_j`` and ``set_mode``; its maintainers name 250 Hz
as the highest rate). So the program itself is the interpolator: it holds few points with their
times, and sends the cubic spline through them, cycle by cycle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.controller import LanguageInfo
from ikplan.plans.export.formats import Arm, Format
from ikplan.plans.export.program_text import (
    comments,
    fixed,
    language_of,
    points_of,
    refuse_longer,
)

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["CYCLE", "FORMAT", "language", "stored"]

_LANGUAGE, _TITLE = "xarm", "xArm SDK"
_JOINTS = (5, 6, 7)
# The arms have no controller block, so that their plans stay as they are.
_ARMS = ("lite6", "xarm5", "xarm6", "xarm7")
CYCLE = 0.004
"""Time between two sets of joint values that the controller takes [s]."""
_DIGITS = 4

# The program behind its points. Steps never come closer than a cycle: after a pause of the host
# the motion goes on where it was, for a jump would be made at full speed.
_PROGRAM = '''

def slopes(times, values):
    """Speeds at the points of the cubic spline that is at rest at both ends."""
    last = len(times) - 1
    steps = [times[k + 1] - times[k] for k in range(last)]
    rises = [(values[k + 1] - values[k]) / steps[k] for k in range(last)]
    upper, right = [0.0] * (last + 1), [0.0] * (last + 1)
    for k in range(1, last):
        row = 3.0 * (steps[k] * rises[k - 1] + steps[k - 1] * rises[k])
        pivot = 2.0 * (steps[k - 1] + steps[k]) - steps[k] * upper[k - 1]
        upper[k] = steps[k - 1] / pivot
        right[k] = (row - steps[k] * right[k - 1]) / pivot
    for k in range(last - 1, 0, -1):
        right[k] -= upper[k] * right[k + 1]
    return right


SPEEDS = list(zip(*(slopes(TIMES, joint) for joint in zip(*POINTS))))


def at(t):
    """Joint values of the spline [deg]."""
    k = min(max(bisect.bisect_right(TIMES, t) - 1, 0), len(TIMES) - 2)
    h = TIMES[k + 1] - TIMES[k]
    x = (t - TIMES[k]) / h
    a, b = (1.0 + 2.0 * x) * (1.0 - x) ** 2, x * (1.0 - x) ** 2 * h
    c, d = x * x * (3.0 - 2.0 * x), x * x * (x - 1.0) * h
    rows = zip(POINTS[k], SPEEDS[k], POINTS[k + 1], SPEEDS[k + 1])
    return [a * q0 + b * v0 + c * q1 + d * v1 for q0, v0, q1, v1 in rows]


def done(code):
    """End where the SDK reports that a call failed."""
    if code != 0:
        raise SystemExit(f"the arm refused, code {code}")


def main():
    arm = XArmAPI(sys.argv[1], is_radian=False)
    done(arm.motion_enable(enable=True))
    done(arm.set_mode(0))
    done(arm.set_state(0))
    done(arm.set_servo_angle(angle=POINTS[0], speed=10, mvacc=20, wait=True))
    done(arm.set_mode(1))
    done(arm.set_state(0))
    time.sleep(0.1)
    due = time.monotonic()
    for k in range(1, math.ceil(TIMES[-1] / CYCLE - 1e-9) + 1):
        due = max(due + CYCLE, time.monotonic())
        time.sleep(max(due - time.monotonic(), 0.0))
        done(arm.set_servo_angle_j(at(min(k * CYCLE, TIMES[-1]))))
    time.sleep(0.1)
    done(arm.set_mode(0))
    done(arm.set_state(0))
    arm.disconnect()


if __name__ == "__main__":
    main()
'''


def language(arm: Arm) -> LanguageInfo:
    """Return what is known of the programs of an arm.

    Raises:
        InvalidRequest: It can have no such program.
    """
    known = {name: LanguageInfo(name=_LANGUAGE, variant="xarm-sdk") for name in _ARMS}
    return language_of(arm, _LANGUAGE, _TITLE, _JOINTS, known)


def check(arm: Arm) -> None:
    """Refuse an arm that the xArm SDK does not move.

    Raises:
        InvalidRequest: It can have no such program.
    """
    language(arm)


def stored(degrees: Array) -> Array:
    """Return what is left of degrees in a program: four decimals."""
    return np.asarray(np.round(degrees, _DIGITS))


def encode(
    plan: PlanDocument,
    name: str = "ikplan_trajectory",  # noqa: ARG001 - a Python program has no name of its own
    robot: Robot | None = None,
    tolerance: float | None = None,
) -> bytes:
    """Return the program: a slow move to the first point, then the spline, one step a cycle.

    Raises:
        InvalidRequest: The arm can have no such program, no points keep the tolerance, or there
            are more points than the longest program has.
    """
    known = language(Arm.of_plan(plan))
    made = points_of(plan, known, "spline", stored, robot, tolerance)
    refuse_longer(known, plan.robot, len(made.degrees))
    due = np.concatenate([[0.0], np.cumsum(made.steps)])
    rows = [f"    [{', '.join(fixed(v, _DIGITS) for v in row)}]," for row in made.degrees]
    lines = [
        "#!/usr/bin/env python3",
        *(f"# {line}" for line in comments(plan, made.certificate)),
        "# This program makes these splines, and sends joint values once a cycle in servo mode.",
        "# Run it on a host with steady timing: python3 FILE ADDRESS_OF_THE_ARM",
        "import bisect",
        "import math",
        "import sys",
        "import time",
        "",
        "from xarm.wrapper import XArmAPI",
        "",
        f"CYCLE = {fixed(CYCLE)}  # s",
        "TIMES = [  # s",
        *(f"    {fixed(t)}," for t in due.tolist()),
        "]",
        "POINTS = [  # deg",
        *rows,
        "]",
    ]
    return ("\n".join(lines) + "\n" + _PROGRAM).encode("ascii")


FORMAT = Format(
    name=_LANGUAGE,
    title="a Python program that streams a spline by the xArm SDK, for UFACTORY arms",
    suffixes=(".xarm.py",),
    media_type="text/x-python-xarm",
    encode=encode,
    check=check,
    program=encode,
    from_rest=True,
)
