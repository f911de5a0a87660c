"""A plan as a DRL program of timed joint moves, for Doosan controllers.

``movej`` moves linearly in the joints, in the time that ``t`` gives. Within the radius ``r`` of a
point the rest of one move is superposed with the begin of the next (Doosan Robotics, programming
manual, movej and its ``ra=DR_MV_RA_DUPLICATE``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.plans.export.formats import Arm, Format
from ikplan.plans.export.program_text import (
    comments,
    fixed,
    language_of,
    points_of,
    refusal,
    refuse_longer,
)

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["FORMAT", "stored"]

_LANGUAGE, _TITLE = "drl", "DRL"
_DIGITS = 4
# Beside its ends a motion has points a few micrometres apart; a radius of 0 stops the arm.
_RADIUS_DIGITS = 4
# To the first point at a walk: whoever runs the program stands beside it [deg/s, deg/s^2].
_APPROACH = "v=10, a=20"


def check(arm: Arm) -> None:
    """Refuse an arm whose controller runs no DRL.

    Raises:
        InvalidRequest: It can have no such program.
    """
    language_of(arm, _LANGUAGE, _TITLE)


def stored(degrees: Array) -> Array:
    """Return what is left of degrees in a program: four decimals."""
    return np.asarray(np.round(degrees, _DIGITS))


def encode(
    plan: PlanDocument,
    name: str = "ikplan_trajectory",  # noqa: ARG001 - a DRL program has no name of its own
    robot: Robot | None = None,
    tolerance: float | None = None,
) -> bytes:
    """Return the program: a slow move to the first point, then a timed move to each of the others.

    Raises:
        InvalidRequest: The arm can have no such program, no points keep the tolerance, there are
            more than the longest program has, or the tool does not move between two of them, so
            that the arm would stop there.
    """
    language = language_of(Arm.of_plan(plan), _LANGUAGE, _TITLE)
    made = points_of(plan, language, "blended", stored, robot, tolerance)
    count = len(made.degrees)
    refuse_longer(language, plan.robot, count)
    scale = 10.0**_RADIUS_DIGITS
    ways = 1e3 * np.linalg.norm(np.diff(made.tool, axis=0), axis=1)
    radii = np.floor(np.minimum(ways[:-1], ways[1:]) / 2.0 * scale) / scale
    if count > 2 and radii.min() <= 0.0:
        at = int(np.argmin(radii)) + 1
        raise refusal(
            _LANGUAGE,
            f"the tool turns without moving near point {at} of the program, and a DRL program "
            "rounds corners within a radius of the tool's way: it would stop there",
        )
    rows = [f"posj({', '.join(fixed(value, _DIGITS) for value in row)})" for row in made.degrees]
    lines = [
        *(f"# {line}" for line in comments(plan, made.certificate)),
        f"movej({rows[0]}, {_APPROACH})",
    ]
    for k, (row, step) in enumerate(zip(rows[1:], made.steps.tolist(), strict=True)):
        radius = f", r={fixed(float(radii[k]), _RADIUS_DIGITS)}" if k < len(radii) else ""
        lines.append(f"movej({row}, t={fixed(step)}{radius}, ra=DR_MV_RA_DUPLICATE)")
    return ("\n".join(lines) + "\n").encode("ascii")


FORMAT = Format(
    name=_LANGUAGE,
    title="a DRL program of timed joint moves, for Doosan arms",
    suffixes=(".drl",),
    media_type="text/x-drl",
    encode=encode,
    check=check,
    program=encode,
    from_rest=True,
)
