"""The fewest points of a plan within a tolerance for what a controller does between them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.errors import InvalidRequest
from ikplan.plans.programs.certificate import ProgramCertificate, ProgramInterpolation
from ikplan.plans.programs.certifying import certify, limits_of
from ikplan.plans.programs.interpolation import interpolate
from ikplan.plans.programs.pace import outwards, slowed, whole_microseconds
from ikplan.plans.programs.reference import Reference
from ikplan.plans.programs.ticks import ANY_TIMES, Times, at_ticks

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
Aim = tuple[float, float, float]
_ROUNDS = 60
# Corners sharper than this share of the limits are given more room where there is some.
_SHARP = 1.3
_UNLIKE = 1.5
_OUTWARDS = 3.0
_TIGHTER = 0.8
_ATTEMPTS = 8


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
    for _ in range(_ATTEMPTS):
        aim = (share * tolerance, share * rotation, SHIFT)
        rows, due, points = _points(reference, kind, aim, limits, times.shortest)
        passed = reference.time[rows]
        if times.tick > 1:
            passed, due, points = at_ticks(plan, kind, passed, due, limits, stored, times.tick)
        else:
            points = stored(points)
            due = whole_microseconds(kind, slowed(kind, due, points, limits), points, limits)
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


def _points(
    reference: Reference,
    kind: ProgramInterpolation,
    aim: Aim,
    limits: tuple[Array, Array],
    shortest: float,
) -> tuple[Indices, Array, Array]:
    """Rows of the grid at which a program has points, when they are due, and the points."""
    # Corners that are moved outwards leave a part of what the moves between them are off.
    loose = _OUTWARDS if kind == "blended" else 1.0
    rows = _first(reference, kind, (loose * aim[0], loose * aim[1], aim[2]), shortest)
    for _ in range(_ROUNDS):
        new = _more_rows(reference, kind, rows, aim, limits, shortest)
        if not len(new):
            break
        rows = np.union1d(rows, new)
    return rows, *_placed(reference, kind, rows, limits)


def _placed(
    reference: Reference, kind: ProgramInterpolation, rows: Indices, limits: tuple[Array, Array]
) -> tuple[Array, Array]:
    """When the points at rows are due, and the points, with corners moved outwards."""
    points = reference.q[rows]
    if kind == "blended":
        points = outwards(reference.time[rows], points)
    due = slowed(kind, reference.time[rows], points, limits)
    return due, outwards(due, reference.q[rows]) if kind == "blended" else points


def _more_rows(
    reference: Reference,
    kind: ProgramInterpolation,
    rows: Indices,
    aim: Aim,
    limits: tuple[Array, Array],
    shortest: float,
) -> Indices:
    """Rows that a program needs beside those it has."""
    if kind == "blended":
        due = reference.time[rows]
        uneven = _uneven(due, outwards(due, reference.q[rows]), rows, limits[1])
        uneven = _apart(reference, rows, uneven, shortest)
        if len(uneven):
            return uneven
    due, points = _placed(reference, kind, rows, limits)
    return _apart(reference, rows, _halves(reference, kind, rows, due, points, aim), shortest)


def _apart(reference: Reference, rows: Indices, new: Indices, shortest: float) -> Indices:
    """Those of new rows that leave no step shorter than the shortest."""
    k = np.searchsorted(rows, new)
    time = reference.time
    gap = np.minimum(time[new] - time[rows[k - 1]], time[rows[k]] - time[new])
    return new[gap >= shortest]


def _first(reference: Reference, kind: ProgramInterpolation, aim: Aim, shortest: float) -> Indices:
    """Rows by the longest steps whose own interpolation keeps the tolerance."""
    least = max(math.ceil(shortest / reference.time[1] - 1e-9), 1)
    rows, last = [0], len(reference.time) - 1
    step = 1
    while rows[-1] < last:
        begin = rows[-1]
        low, high = begin + 1, begin + max(step, 1) + 1
        while high <= last and _step_fits(reference, kind, begin, high, aim):
            low, high = high, begin + 2 * (high - begin)
        high = min(high, last + 1)
        while high - low > 1:
            middle = (low + high) // 2
            if _step_fits(reference, kind, begin, middle, aim):
                low = middle
            else:
                high = middle
        low = max(low, begin + least)
        # What is left for the last step is not shorter either.
        rows.append(low if low + least <= last else last)
        low = rows[-1]
        step = (low - begin) // 2
    return np.array(rows, dtype=np.int64)


def _step_fits(
    reference: Reference, kind: ProgramInterpolation, begin: int, end: int, aim: Aim
) -> bool:
    x = np.linspace(0.0, 1.0, end - begin + 1)[:, None]
    q0, q1 = reference.q[begin], reference.q[end]
    q = q0 + (q1 - q0) * x
    if kind == "spline":
        # A cubic by the slopes of the motion at its ends.
        h = (end - begin) * 1.0
        m0, m1 = (_slope(reference, row) * h for row in (begin, end))
        bend0, bend1 = m0 - (q1 - q0), m1 - (q1 - q0)
        q = q + x * (1.0 - x) ** 2 * bend0 - x**2 * (1.0 - x) * bend1
    found = reference.errors(q, np.arange(begin, end + 1, dtype=np.int64))
    return all(bool(error.max() <= most) for error, most in zip(found, aim, strict=True))


def _slope(reference: Reference, row: int) -> Array:
    """The motion's change of joint values a row, by central differences."""
    before, after = max(row - 1, 0), min(row + 1, len(reference.q) - 1)
    if after - before < 2:
        return np.zeros(reference.q.shape[1])
    return np.asarray((reference.q[after] - reference.q[before]) / 2.0)


def _uneven(due: Array, points: Array, rows: Indices, limit: Array) -> Indices:
    """Middles of steps beside corners that are too sharp as the other step is much shorter.

    A corner is rounded over the shorter of its two steps.
    """
    h = np.diff(due)
    change = np.diff(np.diff(points, axis=0) / h[:, None], axis=0)
    rate = np.abs(change) / np.minimum(h[:-1], h[1:])[:, None]
    sharp = np.nonzero((rate / limit).max(axis=1) > _SHARP)[0]
    longer = np.where(h[sharp] > h[sharp + 1], sharp, sharp + 1)
    shorter = 2 * sharp + 1 - longer
    longer = longer[h[longer] > _UNLIKE * h[shorter]]
    middles = (rows[longer] + rows[longer + 1]) // 2
    return np.unique(middles[middles > rows[longer]])


def _halves(
    reference: Reference,
    kind: ProgramInterpolation,
    rows: Indices,
    due: Array,
    points: Array,
    aim: Aim,
) -> Indices:
    """Middles of the steps in which the whole motion is too far from the path."""
    expected = np.arange(len(reference.time), dtype=np.int64)
    q = interpolate(kind, due, points).at(np.interp(expected, rows, due))
    found = np.array(reference.errors(q, expected))
    over = expected[(found > np.array(aim)[:, None]).any(axis=0)]
    steps = np.unique(np.clip(np.searchsorted(rows, over, side="right") - 1, 0, len(rows) - 2))
    middles = (rows[steps] + rows[steps + 1]) // 2
    return np.asarray(middles[middles > rows[steps]])
