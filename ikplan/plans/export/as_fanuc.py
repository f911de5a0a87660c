"""A plan as a TP program of timed joint moves in text form (LS), for FANUC controllers.

``J P[n] 120msec CNT100`` moves linearly in the joints, in a time of whole milliseconds, and does
not slow down for the point: the end of one move overlaps with the begin of the next (FANUC
R-30iB operator's manual, basic operation, sections on motion instructions and positioning path).
"""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from ikplan.arrays import Array
from ikplan.plans.export.formats import Arm, Format
from ikplan.plans.export.program_text import (
    comments,
    language_of,
    name_from,
    points_of,
    refusal,
    refuse_longer,
    single_precision,
)
from ikplan.plans.programs.times import Times

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["FORMAT", "TIMES", "stored"]

_LANGUAGE, _TITLE = "fanuc-ls", "FANUC"
_LONGEST_NAME = 32
_LONGEST_REMARK = 32
_DIGITS = 3
TIMES = Times(tick=1000, shortest=0.016)
"""Whole milliseconds; two interpolation periods of the controller, 8 ms each, are the shortest."""
# "1 to 32000 msec" in the manual.
_LONGEST_STEP = 32.0
# To the first point at a walk: whoever runs the program stands beside it.
_APPROACH = "5%"
_HEAD = """\
/PROG  {name}
/ATTR
OWNER\t\t= MNEDITOR;
COMMENT\t\t= "ikplan";
PROG_SIZE\t= 0;
FILE_NAME\t= ;
VERSION\t\t= 0;
LINE_COUNT\t= {count};
MEMORY_SIZE\t= 0;
PROTECT\t\t= READ_WRITE;
TCD:  STACK_SIZE\t= 0,
      TASK_PRIORITY\t= 50,
      TIME_SLICE\t= 0,
      BUSY_LAMP_OFF\t= 0,
      ABORT_REQUEST\t= 0,
      PAUSE_REQUEST\t= 0;
DEFAULT_GROUP\t= 1,*,*,*,*;
CONTROL_CODE\t= 00000000 00000000;
/MN"""


def check(arm: Arm) -> None:
    """Refuse an arm whose controller runs no TP programs.

    Raises:
        InvalidRequest: It can have no such program.
    """
    language_of(arm, _LANGUAGE, _TITLE)


def stored(degrees: Array) -> Array:
    """Return what is left of degrees in a program: three decimals, held in single precision."""
    return single_precision(degrees, _DIGITS)


def encode(
    plan: PlanDocument,
    name: str = "ikplan_trajectory",
    robot: Robot | None = None,
    tolerance: float | None = None,
) -> bytes:
    """Return the program: a slow move to the first point, then a timed move to each of the others.

    Raises:
        InvalidRequest: The arm can have no such program, no points keep the tolerance, there are
            more than the longest program has, or a move would take too long.
    """
    language = language_of(Arm.of_plan(plan), _LANGUAGE, _TITLE)
    made = points_of(plan, language, "blended", stored, robot, tolerance, TIMES)
    count = len(made.degrees)
    refuse_longer(language, plan.robot, count)
    if made.steps.max() > _LONGEST_STEP:
        raise refusal(
            _LANGUAGE,
            f"a move of the program would take {made.steps.max():.1f} s, and the longest that "
            f"can be given is {_LONGEST_STEP:g} s: ask for a faster motion",
        )
    remarks = [
        part
        for line in comments(plan, made.certificate)
        for part in textwrap.wrap(line.replace(";", ","), _LONGEST_REMARK - 2)
    ]
    lines = [f"  !{remark}" for remark in remarks]
    lines += ["  UFRAME_NUM=0", "  UTOOL_NUM=1", f"J P[1] {_APPROACH} FINE   "]
    for k, step in enumerate(made.steps.tolist(), start=2):
        zone = "FINE" if k == count else "CNT100"
        lines.append(f"J P[{k}] {round(step * 1e3)}msec {zone}   ")
    body = [_HEAD.format(name=name_from(name, _LONGEST_NAME).upper(), count=len(lines))]
    body += [f"{k:4d}:{line} ;" for k, line in enumerate(lines, start=1)]
    body.append("/POS")
    for k, row in enumerate(made.degrees, start=1):
        values = [f"J{j}= {value + 0.0:9.{_DIGITS}f} deg" for j, value in enumerate(row, start=1)]
        body += [
            f"P[{k}]{{",
            "   GP1:",
            "\tUF : 0, UT : 1,",
            "\t" + ",\t".join(values[:3]) + ",",
            "\t" + ",\t".join(values[3:]),
            "};",
        ]
    body.append("/END")
    return ("\r\n".join("\n".join(body).split("\n")) + "\r\n").encode("ascii")


FORMAT = Format(
    name=_LANGUAGE,
    title="a TP program of timed joint moves in text form, for FANUC arms",
    suffixes=(".ls",),
    media_type="text/x-fanuc-ls",
    encode=encode,
    check=check,
    program=encode,
    from_rest=True,
)
