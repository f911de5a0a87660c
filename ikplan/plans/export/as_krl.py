"""A plan as a KRL program: a spline of the joints with a time for each part, for KUKA controllers.

A ``PTP_SPLINE`` block passes through all of its points without stopping. ``TIME_BLOCK`` gives the
whole of it a time, and each part its share of it (KUKA System Software 8.3, Operating and
Programming Instructions for System Integrators, sections on spline blocks and TIME_BLOCK).
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
    name_from,
    points_of,
    refuse_longer,
    single_precision,
)

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["FORMAT", "stored"]

_LANGUAGE, _TITLE = "krl", "KRL"
# Names of modules have 24 characters at most.
_LONGEST_NAME = 24
_DIGITS = 4
# Shares of the time, in units of a millionth of a percent, add up to 100 % exactly.
_WHOLE = 100_000_000
_APPROACH = 10


def check(arm: Arm) -> None:
    """Refuse an arm whose controller runs no KRL.

    Raises:
        InvalidRequest: It can have no such program.
    """
    language_of(arm, _LANGUAGE, _TITLE)


def stored(degrees: Array) -> Array:
    """Return what is left of degrees in a program: four decimals, held in single precision."""
    return single_precision(degrees, _DIGITS)


def encode(
    plan: PlanDocument,
    name: str = "ikplan_trajectory",
    robot: Robot | None = None,
    tolerance: float | None = None,
) -> bytes:
    """Return the program: a slow PTP to the first point (the BCO run), then one spline.

    Raises:
        InvalidRequest: The arm can have no such program, no points keep the tolerance, or there
            are more points than the longest program has.
    """
    language = language_of(Arm.of_plan(plan), _LANGUAGE, _TITLE)
    made = points_of(plan, language, "spline", stored, robot, tolerance)
    refuse_longer(language, plan.robot, len(made.degrees), "; the arm stops where a spline ends")
    rows = [
        "{"
        + ",".join(f"A{k} {fixed(value, _DIGITS)}" for k, value in enumerate(row, start=1))
        + "}"
        for row in made.degrees
    ]
    total = float(made.steps.sum())
    ends = np.rint(np.cumsum(made.steps) / total * _WHOLE).astype(np.int64)
    shares = np.diff(ends, prepend=0)
    lines = [
        "&ACCESS RVP",
        f"DEF {name_from(name, _LONGEST_NAME)}()",
        *(f"; {line}" for line in comments(plan, made.certificate)),
        "; points are joint values: base and tool do not move them; the load is the tool's",
        "BAS(#INITMOV,0)",
        "$BASE=$NULLFRAME",
        "$TOOL=$NULLFRAME",
        f"BAS(#VEL_PTP,{_APPROACH})",
        f"PTP {rows[0]}",
        "BAS(#VEL_PTP,100)",
        "BAS(#ACC_PTP,100)",
        "PTP_SPLINE",
        f"SPTP {rows[0]}",
        "TIME_BLOCK START",
    ]
    for row, share in zip(rows[1:], shares.tolist(), strict=True):
        lines += [f"SPTP {row}", f"TIME_BLOCK PART={fixed(share * 100.0 / _WHOLE)}"]
    lines += [f"TIME_BLOCK END={fixed(total)}", "ENDSPLINE", "END"]
    return ("\r\n".join(lines) + "\r\n").encode("ascii")


FORMAT = Format(
    name=_LANGUAGE,
    title="a KRL program of one timed spline of the joints, for KUKA arms",
    suffixes=(".src",),
    media_type="text/x-krl",
    encode=encode,
    check=check,
    program=encode,
    from_rest=True,
)
