"""A program read back and played, beside the plan that it was written from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.programs.urscript import play
from ikplan.plans.export import encode
from ikplan.plans.plan import Plan
from ikplan.robots import Robot

__all__ = ["Compared", "compare"]


@dataclass(frozen=True)
class Compared:
    """How far a played program is from its plan.

    Attributes:
        duration: What the program takes longer than the plan [s].
        joints: Largest distance of a joint from the plan's, at any cycle [rad].
        tool: Largest distance of the tool from the plan's [m].
        off_grid: How far the plan's last sample is from the controller's grid [s].
    """

    duration: float
    joints: float
    tool: float
    off_grid: float


def compare(plan: Plan, robot: Robot, cycle: float) -> Compared:
    """Write a plan as a URScript program, play it, and compare.

    Args:
        plan: The plan.
        robot: Its robot.
        cycle: Cycle of the controller that plays it [s].
    """
    played = play(encode(plan, "urscript").decode(), cycle)
    if not played.stopped or played.approach is None:
        raise AssertionError("the program does not end at rest")
    time = np.array(played.time or [0.0])
    q = np.array(played.q or [played.approach])
    known = plan.at(time)[0]
    places = [robot.fk(row).translation for row in q]
    planned = [robot.fk(row).translation for row in known]
    return Compared(
        duration=float(time[-1] - plan.duration),
        joints=float(np.abs(q - known).max()),
        tool=float(np.abs(np.array(places) - np.array(planned)).max()),
        off_grid=float(abs(plan.duration - round(plan.duration / cycle) * cycle)),
    )
