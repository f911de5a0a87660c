"""Points of a program whose times are whole multiples of a coarse tick.

A step that is rounded to its tick would be faster or slower than its neighbours, and the corners
between them sharp. So the points move along the plan instead, to where it is at the ticks.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.plans.playback import evaluate
from ikplan.plans.programs.certificate import ProgramInterpolation
from ikplan.plans.programs.interpolation import interpolate
from ikplan.plans.programs.pace import outwards

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument

__all__ = ["at_ticks"]

_ROUNDS = 40
_MORE = 1e-3


def at_ticks(
    plan: PlanDocument,
    kind: ProgramInterpolation,
    passed: Array,
    due: Array,
    limits: tuple[Array, Array],
    stored: Callable[[Array], Array],
    tick: int,
) -> tuple[Array, Array, Array]:
    """Return a program with its points at whole ticks, slowed until it keeps its limits.

    Args:
        plan: The plan.
        kind: What the controller does between points.
        passed: When the plan is at each point, shape (n,), n >= 2, increasing [s].
        due: When the program is to be there, shape (n,), the first at 0 [s].
        limits: Joint velocities and accelerations, shape (dof,) each.
        stored: From joint values to those that are left of them in a program's text.
        tick: The tick [us].

    Returns:
        When the plan is at each point and when the program is, shape (m,) each, m <= n [s]; the
        points, shape (m, dof) [rad or m].

    Raises:
        InvalidRequest: No pace near the plan's keeps the limits.
    """
    ticks_of_end = due[-1] * 1e6 / tick
    factor = 1.0
    for _ in range(_ROUNDS):
        last = max(int(np.ceil(ticks_of_end * factor - 1e-9)), 1)
        # Points closer than a tick become one.
        at = np.unique(np.rint(due / due[-1] * last).astype(np.int64))
        times = at * (tick / 1e6)
        places = np.interp(at / last, due / due[-1], passed)
        points = evaluate(plan, places)[0]
        if kind == "blended":
            points = outwards(times, points)
        points = stored(points)
        speeds, changes = interpolate(kind, times, points).peaks()
        excess = max(float((speeds / limits[0]).max()), float((changes / limits[1]).max()) ** 0.5)
        if excess <= 1.0:
            return places, times, points
        factor *= max(excess, 1.0 + _MORE)
    raise InvalidRequest(
        f"no program with times of whole {tick / 1e3:g} ms keeps the joint limits",
        field="tolerance",
        allowed="a larger tolerance, or a slower plan",
    )
