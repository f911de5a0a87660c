"""The continuous polish: every waypoint slides on its own solution set, all of them together.

Minimises sum ||q_k - q_k-1|| subject to every target and the limits, by Newton steps in the tangent
spaces of the solution sets. The Hessian is block tridiagonal, so that a step costs time linear in
the number of waypoints.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel
from ikplan.ik.refine import Effort, Workspace, differentiate, new_workspace, refine, residual
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target
from ikplan.planning.candidates import Targets, target_at

__all__ = ["motion_length", "polish"]

Array = NDArray[np.float64]

_AT_LIMIT = 1e-4
"""Nearer to a limit than this, a joint that is pushed out rests: cut short by the limit, its steps
would gain nothing [rad or m]."""


@kernel
def motion_length(q: Array, q_start: Array, start_free: bool) -> float:
    """Return the sum of the joint distances from the start through q, shape (n, dof)."""
    total = 0.0
    for k in range(q.shape[0]):
        if k == 0 and start_free:
            continue
        step = 0.0
        for d in range(q.shape[1]):
            before = q_start[d] if k == 0 else q[k - 1, d]
            step += (q[k, d] - before) ** 2
        total += math.sqrt(step)
    return total


@kernel
def tangent_basis(Jt: Array, fixed: NDArray[np.bool_], basis: Array) -> int:
    """Write an orthonormal basis of the joint motions that keep the target, row by row.

    Args:
        Jt: Transposed Jacobian of the target's error, shape (dof, 6).
        fixed: Joints that may not move, shape (dof,).
        basis: Out: shape (dof, dof); the first rows are the basis.

    Returns:
        Its dimension r.
    """
    dof = Jt.shape[0]
    span = np.zeros((dof, dof))  # orthonormal rows: normals of the constraints, then the basis
    rank = 0
    for j in range(dof):
        if fixed[j]:
            span[rank, j] = 1.0
            rank += 1
    v = np.empty(dof)
    count = 0
    for source in range(6 + dof):
        if rank == dof:
            break
        before = 0.0
        for d in range(dof):
            v[d] = Jt[d, source] if source < 6 else (1.0 if d == source - 6 else 0.0)
            before += v[d] * v[d]
        before = math.sqrt(before)
        if before == 0.0:
            continue
        for _ in range(2):  # twice is enough (Kahan)
            for i in range(rank):
                dot = 0.0
                for d in range(dof):
                    dot += v[d] * span[i, d]
                for d in range(dof):
                    v[d] -= dot * span[i, d]
        after = 0.0
        for d in range(dof):
            after += v[d] * v[d]
        after = math.sqrt(after)
        if after <= (1e-7 if source < 6 else 1e-3) * before:
            continue
        for d in range(dof):
            span[rank, d] = v[d] / after
        if source >= 6:
            basis[count] = span[rank]
            count += 1
        rank += 1
    return count


@kernel
def solve_banded(A: Array, b: Array, size: int, width: int) -> bool:
    """Solve A x = b in place for a symmetric positive definite band matrix, by Cholesky.

    Args:
        A: Lower band, A[i, width - (i - j)] is entry (i, j), shape (size, width + 1).
        b: In: right-hand side, out: x, shape (size,).
        size: Number of unknowns.
        width: Number of subdiagonals.

    Returns:
        Whether the matrix is positive definite.
    """
    for i in range(size):
        for j in range(max(0, i - width), i + 1):
            total = A[i, width - (i - j)]
            for m in range(max(0, i - width, j - width), j):
                total -= A[i, width - (i - m)] * A[j, width - (j - m)]
            if i == j:
                if total <= 0.0:
                    return False
                A[i, width] = math.sqrt(total)
            else:
                A[i, width - (i - j)] = total / A[j, width]
    for i in range(size):
        for m in range(max(0, i - width), i):
            b[i] -= A[i, width - (i - m)] * b[m]
        b[i] /= A[i, width]
    for back in range(size):
        i = size - 1 - back
        for m in range(i + 1, min(size, i + width + 1)):
            b[i] -= A[m, width - (m - i)] * b[m]
        b[i] /= A[i, width]
    return True


@kernel
def _directions(q: Array, q_start: Array, start_free: bool, u: Array, length: Array) -> None:
    """Write the direction and the length of the step into each waypoint."""
    for k in range(q.shape[0]):
        total = 0.0
        for d in range(q.shape[1]):
            before = q_start[d] if k == 0 else q[k - 1, d]
            u[k, d] = q[k, d] - before
            total += u[k, d] ** 2
        length[k] = math.sqrt(total)
        if k == 0 and start_free:
            length[k] = np.inf  # no step: no gradient, no curvature
        scale = 1.0 / length[k] if length[k] > 1e-12 else 0.0
        for d in range(q.shape[1]):
            u[k, d] *= scale


@kernel
def _free_basis(
    Jt: Array,
    q: Array,
    g: Array,
    lower: Array,
    upper: Array,
    fixed: NDArray[np.bool_],
    basis: Array,
) -> int:
    """Write a basis of the motions that keep the target and the limits; return its dimension.

    A joint next to a limit is fixed if the steepest descent within the basis would push it out.
    """
    dof = q.shape[0]
    fixed[:] = False
    for _ in range(dof):
        rank = tangent_basis(Jt, fixed, basis)
        changed = False
        for d in range(dof):
            low, high = q[d] <= lower[d] + _AT_LIMIT, q[d] >= upper[d] - _AT_LIMIT
            if fixed[d] or not (low or high):
                continue
            move = 0.0
            for i in range(rank):
                along = 0.0
                for m in range(dof):
                    along -= basis[i, m] * g[m]
                move += along * basis[i, d]
            if (low and move < -1e-12) or (high and move > 1e-12):
                fixed[d] = True
                changed = True
        if not changed:
            break
    return rank


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
    out[:] = q
    return evaluations


@kernel
def polish(
    chain: Chain,
    targets: Targets,
    q: Array,
    q_start: Array,
    start_free: bool,
    lower: Array,
    upper: Array,
    iterations: int,
    tolerance: float,
) -> tuple[float, int]:
    """Shorten the joint motion through the targets, in place, to a local minimum.

    Args:
        chain: The chain from base to tool.
        targets: The n targets.
        q: In: a solution of each target, out: the shortened ones, shape (n, dof) [rad or m].
        q_start: The start, shape (dof,) [rad or m].
        start_free: Whether the motion begins at the first waypoint.
        lower: Lower bounds, shape (dof,) [rad or m].
        upper: Upper bounds, shape (dof,) [rad or m].
        iterations: Largest number of Newton steps.
        tolerance: Relative gain below which it ends.

    Returns:
        Sum of the joint distances [rad or m] and evaluations spent.
    """
    n, dof = q.shape
    w: Workspace = new_workspace(chain)
    basis, rank = np.zeros((n, dof, dof)), np.zeros(n, dtype=np.int64)
    u, length = np.empty((n, dof)), np.empty(n)
    g, fixed = np.empty(dof), np.zeros(dof, dtype=np.bool_)
    trial, row = np.empty((n, dof)), np.empty(dof)
    place = np.zeros(n + 1, dtype=np.int64)
    best = motion_length(q, q_start, start_free)
    evaluations = 0
    damping = 1e-3
    for _ in range(iterations):
        _directions(q, q_start, start_free, u, length)
        widest = 0
        for k in range(n):
            for d in range(dof):
                g[d] = u[k, d] - (u[k + 1, d] if k + 1 < n else 0.0)  # dL/dq_k
            target = target_at(targets, k)
            residual(chain, target, q[k], w.e, w)
            differentiate(chain, target, w)
            evaluations += 1
            rank[k] = _free_basis(w.Jt, q[k], g, lower, upper, fixed, basis[k])
            place[k + 1] = place[k] + rank[k]
            widest = max(widest, rank[k])
        size = int(place[n])
        if size == 0:
            break
        width = 2 * widest - 1
        A, b = np.zeros((size, width + 1)), np.zeros(size)
        for k in range(n):
            for i in range(rank[k]):
                v = basis[k, i]
                at = place[k] + i
                for d in range(dof):
                    b[at] -= v[d] * (u[k, d] - (u[k + 1, d] if k + 1 < n else 0.0))
                # Blocks of the Hessian of the lengths: (I - u u^T) / length.
                for side in range(2):
                    m = k + side
                    if m >= n:
                        continue
                    h = 1.0 / max(length[m], 1e-6)
                    along = 0.0
                    for d in range(dof):
                        along += v[d] * u[m, d]
                    for d in range(dof):
                        row[d] = h * (v[d] - along * u[m, d])
                    for j in range(i + 1):
                        dot = 0.0
                        for d in range(dof):
                            dot += row[d] * basis[k, j, d]
                        A[at, width - (i - j)] += dot
                    if side == 0 and k > 0:
                        for j in range(rank[k - 1]):
                            dot = 0.0
                            for d in range(dof):
                                dot += row[d] * basis[k - 1, j, d]
                            other = place[k - 1] + j
                            A[at, width - (at - other)] -= dot
                A[at, width] += damping
        if not solve_banded(A, b, size, width):
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
            total = motion_length(trial, q_start, start_free)
            if total < best:
                gained = best - total > tolerance * best
                best = total
                q[:] = trial
                break
            scale *= 0.4
        if not gained:
            break
        damping = max(0.3 * damping, 1e-6)
    return best, evaluations
