r"""A plan as a RAPID module of timed joint moves, for ABB controllers.

``MoveAbsJ`` moves linearly in the joints, in the time that ``\T`` gives. Corners are rounded by
parabolas within zones, and a zone larger than half of the way to the nearest point is reduced to
that (RAPID reference manual, zonedata, and its chapter on positioning during program execution):
so one zone that is large enough rounds every corner over half of the shorter step.
"""

from __future__ import annotations

import math
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
    single_precision,
)

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["FORMAT", "stored"]

_LANGUAGE, _TITLE = "rapid", "RAPID"
# Names have 32 characters at most.
_LONGEST_NAME = 25
_DIGITS = 4
_NO_AXES = "[9E9,9E9,9E9,9E9,9E9,9E9]"
# To the first point at a walk: whoever runs the program stands beside it.
_APPROACH = "v50"


def check(arm: Arm) -> None:
    """Refuse an arm whose controller runs no RAPID.

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
    """Return the module: a slow move to the first point, then a timed move to each of the others.

    Raises:
        InvalidRequest: The arm can have no such program, or no points keep the tolerance.
    """
    language = language_of(Arm.of_plan(plan), _LANGUAGE, _TITLE)
    made = points_of(plan, language, "blended", stored, robot, tolerance)
    name = name_from(name, _LONGEST_NAME)
    rows = [
        f"[[{','.join(fixed(value, _DIGITS) for value in row)}],{_NO_AXES}]" for row in made.degrees
    ]
    moves = [
        f"MoveAbsJ {row}\\NoEOffs,v1000\\T:={fixed(step)},"
        f"{'fine' if k == len(made.steps) else 'ikplan_zone'},tool0;"
        for k, (row, step) in enumerate(zip(rows[1:], made.steps.tolist(), strict=True), start=1)
    ]
    most = language.longest_program or len(moves)
    parts = [moves[k : k + most] for k in range(0, len(moves), most)]
    ways = np.linalg.norm(np.diff(made.tool, axis=0), axis=1)
    size = max(math.ceil(1e3 * float(ways.max()) / 2.0), 1)
    angle = max(math.ceil(math.degrees(float(made.turned.max())) / 2.0), 1)
    lines = [
        f"MODULE {name}_mod",
        *(f"  ! {line}" for line in comments(plan, made.certificate)),
        "  ! no tool, no work object: the points are joint values",
        f"  LOCAL CONST zonedata ikplan_zone:=[FALSE,{size},{size},{size},{angle},{size},{angle}];",
        f"  PROC {name}()",
        f"    MoveAbsJ {rows[0]}\\NoEOffs,{_APPROACH},fine,tool0;",
    ]
    if len(parts) == 1:
        lines += [f"    {move}" for move in parts[0]] + ["  ENDPROC"]
    else:
        # A routine that ends does not stop the arm: corners between routines are rounded too.
        lines += [f"    {name}_{k};" for k in range(1, len(parts) + 1)] + ["  ENDPROC"]
        for k, part in enumerate(parts, start=1):
            lines += [f"  LOCAL PROC {name}_{k}()", *(f"    {m}" for m in part), "  ENDPROC"]
    return ("\n".join([*lines, "ENDMODULE"]) + "\n").encode("ascii")


FORMAT = Format(
    name=_LANGUAGE,
    title="a RAPID module of timed joint moves, for ABB arms",
    suffixes=(".mod",),
    media_type="text/x-rapid",
    encode=encode,
    check=check,
    program=encode,
    from_rest=True,
)
