"""Solutions of a tool pose in closed form: within the limits, nearest to a start, exact."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Flags
from ikplan.copying import copy_into
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.workspace import Workspace, new_workspace
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.closed_form.branches import MOST_BRANCHES, branches_into
from ikplan.kinematics.closed_form.form import NO_FORM, ClosedForm
from ikplan.kinematics.target import (
    ORIENTATION_WEIGHT,
    Freedom,
    Target,
    pose_defect,
)

__all__ = ["closed_form_solutions", "has_closed_form", "solve_closed_form_pose"]

_AT_LIMIT = 1e-9
"""A joint value beyond its limit by less than this is at it [rad]."""
_POLISH = Effort(6, 6)
"""Steps that bring a branch from rounding to the last digit."""


@leaf_kernel
def has_closed_form(form: ClosedForm, target: Target) -> bool:
    """Whether the solutions of a target are a few branches that are known in closed form."""
    fixed = target.oriented and target.freedom.axis < 0 and not target.freedom.boxed
    return form.kind != NO_FORM and fixed


@leaf_kernel
def _turned_inside(q: Array, near: Array, lower: Array, upper: Array) -> bool:
    """Bring each angle to its 2 pi copy inside the limits that is nearest to ``near``, in place.

    Returns:
        Whether each has one; a value that is beyond its limit by rounding is set to it.
    """
    turn = 2.0 * math.pi
    for k in range(q.shape[0]):
        value = q[k] + turn * math.floor((near[k] - q[k]) / turn + 0.5)
        if value < lower[k] - _AT_LIMIT:
            value += turn * math.ceil((lower[k] - _AT_LIMIT - value) / turn)
        elif value > upper[k] + _AT_LIMIT:
            value -= turn * math.ceil((value - upper[k] - _AT_LIMIT) / turn)
        if value < lower[k] - _AT_LIMIT or value > upper[k] + _AT_LIMIT:
            return False
        q[k] = min(max(value, lower[k]), upper[k])
    return True


@leaf_kernel
def _length(a: Array, b: Array) -> float:
    squared = 0.0
    for k in range(a.shape[0]):
        squared += (a[k] - b[k]) ** 2
    return math.sqrt(squared)


@leaf_kernel
def _inside_nearest_first(
    form: ClosedForm,
    R: Array,
    p: Array,
    near: Array,
    lower: Array,
    upper: Array,
    rows: Array,
    lengths: Array,
) -> tuple[int, bool]:
    """Write the branches inside the limits, nearest first; their number, and whether all count."""
    branches, unsure = branches_into(form, R, p, rows)
    count = 0
    for i in range(branches):
        if not _turned_inside(rows[i], near, lower, upper):
            continue
        length = _length(rows[i], near)
        # The branch takes its place among those before it; what it overwrites has been read.
        place = count
        while place > 0 and length < lengths[place - 1]:
            place -= 1
        for k in range(rows.shape[1]):
            value = rows[i, k]
            for j in range(count, place, -1):
                rows[j, k] = rows[j - 1, k]
            rows[place, k] = value
        for j in range(count, place, -1):
            lengths[j] = lengths[j - 1]
        lengths[place] = length
        count += 1
    return count, not unsure


@kernel
def closed_form_solutions(
    chain: Chain,
    form: ClosedForm,
    target: Target,
    near: Array,
    lower: Array,
    upper: Array,
    tolerance: float,
    solutions: Array,
    w: Workspace,
) -> tuple[int, bool, int]:
    """Write every solution of a target within the limits, nearest first.

    Args:
        chain: The chain from base to tool.
        form: Its closed form.
        target: A target that ``has_closed_form``.
        near: Configuration to be near to, shape (6,) [rad]: each joint is at the 2 pi copy inside
            its limits that is nearest to it.
        lower: Lower limits, -inf for a joint without, shape (6,) [rad].
        upper: Upper limits, shape (6,) [rad].
        tolerance: Error that counts as solved [m and rad].
        solutions: Out: solutions, shape (8, 6) [rad].
        w: Buffers of the chain.

    Returns:
        Number of solutions; whether these are surely all; evaluations spent.
    """
    lengths = np.empty(MOST_BRANCHES)
    count, all_found = _inside_nearest_first(
        form, target.R, target.p, near, lower, upper, solutions, lengths
    )
    kept, evaluations = 0, 0
    for i in range(count):
        distance, angle, spent = refine(chain, target, solutions[i], lower, upper, _POLISH, w)
        evaluations += spent
        if distance <= tolerance and angle <= tolerance:
            copy_into(solutions[kept], solutions[i])
            kept += 1
        else:
            all_found = False
    return kept, all_found, evaluations


@kernel
def solve_closed_form_pose(
    placements: Array,
    prismatic: Flags,
    coupled: bool,
    coupling: Array,
    offset: Array,
    kind: int,
    h: Array,
    v: Array,
    sign: Array,
    R_zero: Array,
    centre: Array,
    T: Array,
    q_start: Array,
    lower: Array,
    upper: Array,
    tolerance_position: float,
    tolerance_orientation: float,
    q: Array,
) -> tuple[float, float, float, int]:
    """Find the solution of one pose that is nearest to the start.

    The call costs as much as the work, so that few named tuples are passed: see
    :func:`ikplan.ik.poses.kernels.solve_lm_pose`.

    Args:
        placements: Of the chain from base to tool.
        prismatic: Of the chain.
        coupled: Of the chain.
        coupling: Of the chain.
        offset: Of the chain.
        kind: Of the closed form.
        h: Of the closed form.
        v: Of the closed form.
        sign: Of the closed form.
        R_zero: Of the closed form.
        centre: Of the closed form.
        T: Tool pose wanted, homogeneous, shape (4, 4), in any layout.
        q_start: Configuration to be near to, shape (6,) [rad].
        lower: Lower limits, shape (6,) [rad].
        upper: Upper limits, shape (6,) [rad].
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        q: Out: the solution, shape (6,) [rad].

    Returns:
        Distance [m], rotation angle [rad] and joint distance from the start [rad] of the
        solution, and evaluations spent. Infinities: T is no pose to rounding, it is singular, or
        there is no solution.
    """
    R, p = np.empty((3, 3)), np.empty(3)
    for i in range(3):
        p[i] = T[i, 3]
        for j in range(3):
            R[i, j] = T[i, j]
    if not pose_defect(R, p) <= 1e-13:
        return math.inf, math.inf, math.inf, 0
    chain = Chain(placements, prismatic, coupled, coupling, offset)
    form = ClosedForm(kind, h, v, sign, R_zero, centre)
    rows, lengths = np.empty((MOST_BRANCHES, 6)), np.empty(MOST_BRANCHES)
    count, all_found = _inside_nearest_first(form, R, p, q_start, lower, upper, rows, lengths)
    if not all_found or count == 0:
        return math.inf, math.inf, math.inf, 0
    none = Freedom(-1, 0.0, False, p, False, R)
    target = Target(R, p, True, ORIENTATION_WEIGHT, none)
    for k in range(6):
        q[k] = rows[0, k]
    distance, angle, evaluations = refine(
        chain, target, q, lower, upper, _POLISH, new_workspace(chain)
    )
    if distance > tolerance_position or angle > tolerance_orientation:
        return math.inf, math.inf, math.inf, 0
    return distance, angle, _length(q, q_start), evaluations
