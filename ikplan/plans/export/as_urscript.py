"""A plan as a URScript program of ``servoj`` steps, for controllers that run URScript."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.plans.export.formats import Arm, Format
from ikplan.plans.export.resampling import positions_at_cycle

if TYPE_CHECKING:
    from ikplan.documents.controller import LanguageInfo
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["FORMAT"]

_LANGUAGE = "urscript"
_FUNCTION = "ikplan_trajectory"
_JOINTS = 6
# To the first sample at a walk: whoever runs the program stands beside it.
_APPROACH = "a=0.5, v=0.25"
_SERVO = "lookahead_time=0.1, gain=300"
# Digits after the point, written out: URScript has no exponents for certain.
_DIGITS = 9
_VARIANTS = {"cb3": "CB3", "e-series": "e-Series"}


def check(arm: Arm) -> None:
    """Refuse an arm whose controller runs no URScript.

    Raises:
        InvalidRequest: Its controller is not known, runs other programs, or the arm does not have
            six turning joints.
    """
    _language(arm)


def _language(arm: Arm) -> LanguageInfo:
    controller = arm.controller
    found = controller.language(_LANGUAGE) if controller is not None else None
    if found is None:
        why = "its controller runs none" if controller is not None else "no controller is known"
        raise _refusal(
            f"no URScript program for {arm.robot!r}: {why}; a robot whose controller has the "
            f'language "{_LANGUAGE}" can have one'
        )
    if arm.units != ("rad",) * _JOINTS:
        raise _refusal(
            f"no URScript program for {arm.robot!r}: URScript moves six turning joints, and this "
            f"chain has {len(arm.units)} joints ({', '.join(arm.units)})"
        )
    return found


def encode(plan: PlanDocument) -> bytes:
    """Return the program: a slow ``movej`` to the first sample, then one ``servoj`` a cycle.

    Joint values are in rad. Each step takes the controller's cycle, so that the program takes as
    long as the plan. The last line calls the function: the program runs from the script interface
    and from a file alike.

    Raises:
        InvalidRequest: The arm can have no such program, the plan's samples are too far apart,
            or the program would be longer than the controller's longest.
    """
    arm = Arm.of_plan(plan)
    language = _language(arm)
    assert arm.controller is not None  # it has a language
    cycle = arm.controller.cycle
    q = positions_at_cycle(plan, cycle)
    longest = language.longest_program
    if longest is not None and len(q) > longest:
        raise _refusal(
            f"the program would have {len(q)} samples, and the longest that the controller of "
            f"{plan.robot!r} is known to run has {longest} ({(longest - 1) * cycle:g} s); plan the "
            "path in parts of at most that duration, each from where the one before ends, or give "
            "the robot's controller another longest_program"
        )
    rows = _rows(q)
    variant = _VARIANTS.get(language.variant, language.variant)
    step = f"t={_fixed(cycle)}, {_SERVO}"
    lines = [
        f"def {_FUNCTION}():",
        f"  # plan {plan.id} for {plan.robot}, {variant}: {len(q)} samples, one each "
        f"{_fixed(cycle)} s, in {_fixed((len(q) - 1) * cycle)} s",
        f"  movej({rows[0]}, {_APPROACH})",
        *(f"  servoj({row}, {step})" for row in rows[1:]),
        "  stopj(2.0)",
        "end",
        f"{_FUNCTION}()",
    ]
    return ("\n".join(lines) + "\n").encode()


def _rows(q: Array) -> list[str]:
    # Adding zero turns -0.0 into 0.0.
    rounded = (np.round(q, _DIGITS) + 0.0).tolist()
    return [f"[{', '.join(f'{value:.{_DIGITS}f}' for value in row)}]" for row in rounded]


def _fixed(seconds: float) -> str:
    """A time in decimals, to the nanosecond, without trailing zeros."""
    return f"{seconds:.9f}".rstrip("0").rstrip(".")


def _refusal(detail: str) -> InvalidRequest:
    return InvalidRequest(detail, field="format", allowed=f"another format than {_LANGUAGE}")


FORMAT = Format(
    name=_LANGUAGE,
    title="a URScript program of servoj steps, for arms whose controller runs URScript",
    suffixes=(".script",),
    media_type="text/x-urscript",
    encode=encode,
    check=check,
    from_rest=True,
)
