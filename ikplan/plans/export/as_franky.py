"""A plan as a Python program of waypoints for franky, for Franka arms.

``JointWaypointMotion`` of franky (PyPI ``franky-control``, 2.0) gives its waypoints to Ruckig, one
after the other, in position control at 1 kHz. Each has joint values and velocities, and a least
time in whole milliseconds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan.documents.controller import LanguageInfo
from ikplan.plans.export.formats import Arm, Format
from ikplan.plans.export.program_text import (
    comments,
    fixed,
    known_robot,
    language_of,
    refusal,
    refuse_longer,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["FORMAT", "language"]

_LANGUAGE, _TITLE = "franky", "franky"
_JOINTS = (7,)
# Their controller blocks name no languages, so that their plans stay as they are.
_ARMS = ("fer", "fr3", "panda")
_DIGITS = 6
# To the first waypoint at a walk: whoever runs the program stands beside it.
_APPROACH = 0.05

_PROGRAM = """

def main():
    robot = Robot(sys.argv[1])
    robot.relative_dynamics_factor = APPROACH
    robot.move(JointMotion(START))
    robot.relative_dynamics_factor = 1.0
    robot.joint_velocity_limit.set(VELOCITY)
    robot.joint_acceleration_limit.set(ACCELERATION)
    robot.joint_jerk_limit.set(JERK)
    waypoints = [
        JointWaypoint(JointState(q, dq), minimum_time=Duration(least))
        for least, q, dq in WAYPOINTS
    ]
    robot.move(JointWaypointMotion(waypoints))


if __name__ == "__main__":
    main()
"""


def language(arm: Arm) -> LanguageInfo:
    """Return what is known of the programs of an arm.

    Raises:
        InvalidRequest: It can have no such program.
    """
    known = {name: LanguageInfo(name=_LANGUAGE, variant="franky-2") for name in _ARMS}
    return language_of(arm, _LANGUAGE, _TITLE, _JOINTS, known)


def check(arm: Arm) -> None:
    """Refuse an arm that franky does not move.

    Raises:
        InvalidRequest: It can have no such program.
    """
    language(arm)
    if arm.controller is None or arm.controller.jerk is None:
        raise refusal(
            _LANGUAGE, f"no franky program for {arm.robot!r}: its controller has no jerk limits"
        )


def encode(
    plan: PlanDocument,
    name: str = "ikplan_trajectory",  # noqa: ARG001 - a Python program has no name of its own
    robot: Robot | None = None,
    tolerance: float | None = None,
) -> bytes:
    """Return the program: a slow move to the first waypoint, then one motion through the others.

    Raises:
        InvalidRequest: The arm can have no such program, no waypoints keep the tolerance, there
            are more than the longest program has, or Ruckig is not installed.
    """
    from ikplan.plans.programs.thinning import TOLERANCE
    from ikplan.plans.programs.waypoints import waypoints

    arm = Arm.of_plan(plan)
    check(arm)
    known = known_robot(plan, _LANGUAGE, robot)
    made = waypoints(plan, known, TOLERANCE if tolerance is None else tolerance)
    refuse_longer(language(arm), plan.robot, len(made.q), "; the arm stops where a motion ends")
    rows = zip(made.least, made.q[1:].tolist(), made.dq[1:].tolist(), strict=True)
    velocity, acceleration, jerk = made.limits.tolist()
    lines = [
        "#!/usr/bin/env python3",
        *(f"# {line}" for line in comments(plan, made.certificate)),
        "# Run it on a host with a real-time kernel: python3 FILE ADDRESS_OF_THE_ARM",
        "import sys",
        "",
        "from franky import (",
        "    Duration,",
        "    JointMotion,",
        "    JointState,",
        "    JointWaypoint,",
        "    JointWaypointMotion,",
        "    Robot,",
        ")",
        "",
        f"APPROACH = {fixed(_APPROACH)}  # share of the limits",
        f"VELOCITY = {_list(velocity, 9)}  # rad/s",
        f"ACCELERATION = {_list(acceleration, 9)}  # rad/s^2",
        f"JERK = {_list(jerk, 9)}  # rad/s^3",
        f"START = {_list(made.q[0].tolist())}  # rad",
        "WAYPOINTS = [  # least time [ms], joint values [rad], joint velocities [rad/s]",
        *(f"    ({least}, {_list(q)}, {_list(dq)})," for least, q, dq in rows),
        "]",
    ]
    return ("\n".join(lines) + "\n" + _PROGRAM).encode("ascii")


def _list(values: Iterable[float], digits: int = _DIGITS) -> str:
    return f"[{', '.join(fixed(value, digits) for value in values)}]"


FORMAT = Format(
    name=_LANGUAGE,
    title="a Python program of waypoints for franky, for Franka arms",
    suffixes=(".franky.py",),
    media_type="text/x-python-franky",
    encode=encode,
    check=check,
    program=encode,
    from_rest=True,
)
