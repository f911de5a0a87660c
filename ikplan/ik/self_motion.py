"""The slide of a solution along its self-motion to the one nearest to a start configuration.

Projected gradient descent of ||q - q_start||^2 / 2 on the manifold of solutions, with the step
length of Barzilai and Borwein, "Two-Point Step Size Gradient Methods", IMA J. Numerical Analysis
1988, 8, Eq. 5: on the one-dimensional self-motion of a seven-joint arm it is the secant method.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array
from ikplan.copying import copy_into
from ikplan.ik.levenberg_marquardt import (
    Effort,
    Workspace,
    differentiate,
    normal_matrix,
    refine,
    residual,
    solve_rows,
)
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target, constraint_rows

__all__ = ["nearest_on_manifold"]


_LONGEST = 0.5
"""Longest step along the manifold [rad or m]."""
_DAMPING = 1e-10
_AT_LIMIT = 1e-6
"""Nearer to a limit than this, a joint that is pushed out rests on it [rad or m]."""


@leaf_kernel
def _pull(q: Array, q_start: Array, lower: Array, upper: Array, w: Workspace) -> float:
    """Write to ``w.dq`` the way to the start that leaves the target alone; return its length.

    q_start - q less what of it moves the tool; joints at a limit that would be pushed out rest on
    it.
    """
    Jt, y, dq, free = w.Jt, w.y, w.dq, w.free
    dof = q.shape[0]
    for j in range(dof):
        free[j] = True
    length = 0.0
    for _ in range(dof):
        # dq = d - J^T (J J^T)^-1 J d over the free joints, d = q_start - q
        normal_matrix(w)
        for i in range(6):
            y[i] = 0.0
            for j in range(dof):
                if free[j]:
                    y[i] += Jt[j, i] * (q_start[j] - q[j])
        solve_rows(_DAMPING, w)
        changed, length = False, 0.0
        for j in range(dof):
            if not free[j]:
                continue
            dq[j] = q_start[j] - q[j]
            for i in range(6):
                dq[j] -= Jt[j, i] * y[i]
            to_lower, to_upper = lower[j] - q[j], upper[j] - q[j]
            if (dq[j] < 0.0 and to_lower > -_AT_LIMIT) or (dq[j] > 0.0 and to_upper < _AT_LIMIT):
                dq[j] = to_lower if dq[j] < 0.0 else to_upper
                free[j] = False
                changed = True
            else:
                length += dq[j] * dq[j]
        if not changed:
            break
    return math.sqrt(length)


@leaf_kernel
def _step(q: Array, q_start: Array, lower: Array, upper: Array, scale: float, w: Workspace) -> None:
    """Scale ``w.dq``; a joint it would take past a limit stops there, and the others make up."""
    Jt, y, dq, free = w.Jt, w.y, w.dq, w.free
    dof = q.shape[0]
    for j in range(dof):
        if free[j]:
            dq[j] *= scale
    for _ in range(dof):
        changed = False
        for j in range(dof):
            if free[j] and (q[j] + dq[j] < lower[j] or q[j] + dq[j] > upper[j]):
                dq[j] = min(max(q[j] + dq[j], lower[j]), upper[j]) - q[j]
                free[j] = False
                changed = True
        if not changed:
            return
        normal_matrix(w)
        for i in range(6):
            y[i] = 0.0
            for j in range(dof):
                y[i] += Jt[j, i] * (scale * (q_start[j] - q[j]) if free[j] else dq[j])
        solve_rows(_DAMPING, w)
        for j in range(dof):
            if free[j]:
                dq[j] = scale * (q_start[j] - q[j])
                for i in range(6):
                    dq[j] -= Jt[j, i] * y[i]


@kernel
def nearest_on_manifold(
    chain: Chain,
    target: Target,
    q: Array,
    q_start: Array,
    lower: Array,
    upper: Array,
    iterations: int,
    w: Workspace,
) -> int:
    """Slide a solution along its self-motion manifold, in place, nearest to ``q_start``.

    Ends where no small motion that keeps the target and the limits gets nearer. The result is never
    farther from ``q_start`` than the solution given, and no farther from the target than that, or
    than 1e-11.

    Args:
        chain: The chain from base to tool.
        target: The tool pose wanted.
        q: In: a solution, out: the nearest solution of its manifold, shape (dof,) [rad or m].
        q_start: Configuration to be near to, shape (dof,) [rad or m].
        lower: Lower position limits, shape (dof,) [rad or m].
        upper: Upper position limits, shape (dof,) [rad or m].
        iterations: Largest number of steps.
        w: Buffers of the chain.

    Returns:
        Evaluations spent.
    """
    dof = q.shape[0]
    if dof <= constraint_rows(target):
        return 0
    first_distance, first_angle, _ = residual(chain, target, q, w.e, w)
    evaluations = 1
    here, before, pull, pull_before = np.empty(dof), np.empty(dof), np.empty(dof), np.empty(dof)
    best = 0.0
    for j in range(dof):
        best += (q[j] - q_start[j]) ** 2
    scale = 1.0
    for iteration in range(iterations):
        copy_into(here, q)
        differentiate(chain, target, w)
        length = _pull(here, q_start, lower, upper, w)
        copy_into(pull, w.dq)
        if iteration > 0:
            moved, turned = 0.0, 0.0
            for j in range(dof):
                moved += (here[j] - before[j]) ** 2
                turned += (here[j] - before[j]) * (pull_before[j] - pull[j])
            scale = min(moved / turned, 1e3) if turned > 0.0 else 4.0 * scale
        scale = min(scale, _LONGEST / max(length, 1e-300))
        copy_into(before, here)
        copy_into(pull_before, pull)
        nearer = False
        for attempt in range(10):
            # What there is to gain must show in the digits of the distance.
            if length < 1e-10 or scale * length * length < 1e-15 * best:
                break
            if attempt > 0:
                residual(chain, target, here, w.e, w)
                differentiate(chain, target, w)
                evaluations += 1
                _pull(here, q_start, lower, upper, w)
            _step(here, q_start, lower, upper, scale, w)
            for j in range(dof):
                q[j] = min(max(here[j] + w.dq[j], lower[j]), upper[j])
            distance, angle, spent = refine(chain, target, q, lower, upper, Effort(12, 8), w)
            evaluations += spent
            total = 0.0
            for j in range(dof):
                total += (q[j] - q_start[j]) ** 2
            exact = distance <= max(first_distance, 1e-11) and angle <= max(first_angle, 1e-11)
            if exact and total < best:
                nearer, best = True, total
                break
            copy_into(q, here)
            scale *= 0.25
        if not nearer:
            break
        residual(chain, target, q, w.e, w)
        evaluations += 1
    return evaluations
