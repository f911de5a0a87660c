"""Path shortening: every waypoint slides on its own solution set, all of them together.

Minimises sum ||W (q_k - q_k-1)||, and the mean distance from a posture where one is preferred,
subject to every target and the limits, by Newton steps in the tangent
spaces of the solution sets. The Hessian is block tridiagonal, so that a step costs time linear in
the number of waypoints.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.copying import copy_into, copy_rows_into
from ikplan.ik.levenberg_marquardt import (
    Effort,
    Workspace,
    differentiate,
    new_workspace,
    refine,
    residual,
)
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target
from ikplan.planning.ladder.banded_newton import newton_step
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.ladder.motion_cost import MotionCost, posture_distance, sequence_cost

__all__ = ["shorten_sequence"]


@kernel
def _directions(
    q: Array, q_start: Array, start_free: bool, weights: Array, u: Array, length: Array
) -> None:
    """Write the direction and the length of the weighted step into each waypoint."""
    for k in range(q.shape[0]):
        total = 0.0
        for d in range(q.shape[1]):
            before = q_start[d] if k == 0 else q[k - 1, d]
            u[k, d] = weights[d] * (q[k, d] - before)
            total += u[k, d] ** 2
        length[k] = math.sqrt(total)
        if k == 0 and start_free:
            length[k] = np.inf  # no step: no gradient, no curvature
        scale = 1.0 / length[k] if length[k] > 1e-12 else 0.0
        for d in range(q.shape[1]):
            u[k, d] *= scale


@kernel
def _postures(q: Array, cost: MotionCost, u: Array, length: Array) -> None:
    """Write the direction and the length of each waypoint's way from the preferred ranges."""
    for k in range(q.shape[0]):
        length[k] = posture_distance(q[k], cost)
        scale = 1.0 / length[k] if length[k] > 1e-12 else 0.0
        for d in range(q.shape[1]):
            outside = max(q[k, d] - cost.upper[d], 0.0) - max(cost.lower[d] - q[k, d], 0.0)
            u[k, d] = scale * cost.weights[d] * outside


@kernel
def _slide(
    chain: Chain,
    target: Target,
    q: Array,
    basis: Array,
    step: Array,
    scale: float,
    lower: Array,
    upper: Array,
    out: Array,
    w: Workspace,
) -> int:
    """Write the waypoint moved by its step and brought back onto its target; the evaluations.

    A step that the limits bar is shortened on its own, so that one waypoint does not hold up all.
    """
    evaluations = 0
    for _ in range(3):
        for d in range(q.shape[0]):
            value = q[d]
            for i in range(step.shape[0]):
                value += scale * step[i] * basis[i, d]
            out[d] = min(max(value, lower[d]), upper[d])
        distance, angle, spent = refine(chain, target, out, lower, upper, Effort(12, 8), w)
        evaluations += spent
        if distance <= 1e-9 and angle <= 1e-9:
            return evaluations
        scale *= 0.3
    copy_into(out, q)
    return evaluations


@kernel
def shorten_sequence(
    chain: Chain,
    targets: Targets,
    q: Array,
    q_start: Array,
    start_free: bool,
    lower: Array,
    upper: Array,
    cost: MotionCost,
    iterations: int,
    tolerance: float,
) -> tuple[float, int]:
    """Lower the cost of the motion through the targets, in place, to a local minimum.

    Args:
        chain: The chain from base to tool.
        targets: The n targets.
        q: In: a solution of each target, out: the shortened ones, shape (n, dof) [rad or m].
        q_start: The start, shape (dof,) [rad or m].
        start_free: Whether the motion begins at the first waypoint.
        lower: Lower bounds, shape (dof,) [rad or m].
        upper: Upper bounds, shape (dof,) [rad or m].
        cost: What the motion costs.
        iterations: Largest number of Newton steps.
        tolerance: Relative gain below which it ends.

    Returns:
        Cost [rad or m] and evaluations spent.
    """
    n, dof = q.shape
    w: Workspace = new_workspace(chain)
    basis, rank = np.zeros((n, dof, dof)), np.zeros(n, dtype=np.int64)
    fixed, place = np.zeros((n, dof), dtype=np.bool_), np.zeros(n + 1, dtype=np.int64)
    u, length, Jt, trial = (
        np.empty((n, dof)),
        np.empty(n),
        np.empty((n, dof, 6)),
        np.empty((n, dof)),
    )
    aside, away = np.zeros((n, dof)), np.zeros(n)
    best = sequence_cost(q, q_start, start_free, cost)
    evaluations = 0
    damping = 1e-3
    for _ in range(iterations):
        _directions(q, q_start, start_free, cost.weights, u, length)
        if cost.pull > 0.0:
            _postures(q, cost, aside, away)
        for k in range(n):
            residual(chain, target_at(targets, k), q[k], w.e, w)
            differentiate(chain, target_at(targets, k), w)
            copy_rows_into(Jt[k], w.Jt)
        evaluations += n
        regular, b = newton_step(
            u, length, aside, away, q, Jt, lower, upper, cost, damping, basis, rank, place, fixed
        )
        if b.shape[0] == 0:
            break
        if not regular:
            damping = 10.0 * damping
            continue
        # No waypoint slides by more than half a radian at once.
        longest = 0.0
        for k in range(n):
            total = 0.0
            for i in range(rank[k]):
                total += b[place[k] + i] ** 2
            longest = max(longest, math.sqrt(total))
        scale = min(1.0, 0.5 / longest) if longest > 0.0 else 1.0
        gained = False
        for _half in range(5):
            for k in range(n):
                evaluations += _slide(
                    chain, target_at(targets, k), q[k], basis[k], b[place[k] : place[k + 1]],
                    scale, lower, upper, trial[k], w
                )  # fmt: skip
            total = sequence_cost(trial, q_start, start_free, cost)
            if total < best:
                gained = best - total > tolerance * best
                best = total
                copy_rows_into(q, trial)
                break
            scale *= 0.4
        if not gained:
            break
        damping = max(0.3 * damping, 1e-6)
    return best, evaluations
