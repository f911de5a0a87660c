"""The fewest points of a plan within a tolerance for what a controller does between them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.plans.programs.certificate import ProgramCertificate, ProgramInterpolation
from ikplan.plans.programs.certifying import certify, limits_of
from ikplan.plans.programs.pace import slowed, whole_microseconds
from ikplan.plans.programs.reference import Reference
from ikplan.plans.programs.rows import RowChoice
from ikplan.plans.programs.ticks import at_ticks
from ikplan.plans.programs.times import ANY_TIMES, Times

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["ROTATION", "TOLERANCE", "Program", "thin"]

TOLERANCE = 1e-4
"""How far the tool may be from the plan's path if nothing else is asked for [m]."""
ROTATION = 1e-3
"""How far the tool may be turned from the plan's orientation if nothing else is asked for [rad]."""
SHIFT = 0.02
"""How early or late a place of the path may be passed between two points [s]."""
_TIGHTER = 0.8
_ATTEMPTS = 8
_COARSE = 2


@dataclass(frozen=True)
class Program:
    """Points of a program.

    Attributes:
        time: When each point is due, shape (n,), the first at 0, whole ticks apart [s].
        q: Joint values, shape (n, dof) [rad or m].
        certificate: What holds of the motion that the controller makes of them.
    """

    time: Array
    q: Array
    certificate: ProgramCertificate


def thin(
    plan: PlanDocument,
    robot: Robot,
    kind: ProgramInterpolation,
    tolerance: float = TOLERANCE,
    rotation: float = ROTATION,
    stored: Callable[[Array], Array] = np.asarray,
    times: Times = ANY_TIMES,
) -> Program:
    """Return a program of few points for a plan.

    From each point the next one is as late as the tolerance allows for the interpolation between
    the two; then points are put in wherever the motion as a whole, with its corners or as a
    spline, is too far from the path. Corners that can be are moved outwards, so that the rounded
    motion passes through the plan's. At last the program is slowed by the least factor that
    keeps the joint limits, and measured.

    Args:
        plan: The plan.
        robot: Its robot, with its tool if the tolerance is to hold there.
        kind: What the controller does between points.
        tolerance: Largest distance of the tool from the path [m].
        rotation: Largest rotation of the tool from the plan's orientation [rad].
        stored: From joint values to those that are left of them in a program's text.
        times: What the steps of a program may take.

    Raises:
        InvalidRequest: No points of the plan keep the tolerance.
    """
    if len(plan.time) == 1:
        raise InvalidRequest(
            "a plan that does not move has no program", field="format", allowed="a plan that moves"
        )
    reference = Reference.of(plan, robot)
    limits = limits_of(plan, robot)
    share, found = 1.0, None
    for attempt in range(_ATTEMPTS):
        # Steps that are too short are put together first; where that is too coarse, slowed.
        apart = times.shortest if attempt < _COARSE else 0.0
        aim = (share * tolerance, share * rotation, SHIFT)
        choice = RowChoice(reference, kind, limits, aim, times.shortest, apart)
        rows, due, points = choice.points()
        passed = reference.time[rows]
        if times.tick > 1:
            passed, due, points = at_ticks(plan, kind, passed, due, limits, stored, times.tick)
        else:
            points = stored(points)
            due = whole_microseconds(
                kind, slowed(kind, due, points, limits, times.shortest), points, limits
            )
        found = certify(plan, robot, kind, passed, due, points, tolerance)
        if found.max_path_deviation <= tolerance and found.max_orientation_deviation <= rotation:
            return Program(due, points, found)
        share *= _TIGHTER
    assert found is not None
    raise InvalidRequest(
        f"no program of {kind} moves is within {tolerance:g} m and {rotation:g} rad of the plan: "
        f"the closest is {found.max_path_deviation:.2g} m and "
        f"{found.max_orientation_deviation:.2g} rad from it",
        field="tolerance",
        allowed=f"at least {found.max_path_deviation:.2g} m",
    )
