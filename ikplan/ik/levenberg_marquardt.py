"""Levenberg-Marquardt on SE(3) with joint limits.

Source of the damping: Sugihara, "Solvability-Unconcerned Inverse Kinematics by the
Levenberg-Marquardt Method", IEEE Trans. Robotics 2011, 27(5), Eq. 31: the damping is the residual
itself. The limits are an active set: a joint at its limit that the step would push out rests.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array
from ikplan.ik.free_rows import box_error, free_rows, lean_error
from ikplan.ik.workspace import Workspace, new_workspace
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_into, jacobian_into, pose_error
from ikplan.kinematics.target import Target

__all__ = [
    "Effort",
    "Workspace",
    "differentiate",
    "new_workspace",
    "normal_matrix",
    "refine",
    "residual",
    "solve_rows",
    "target_error",
]


class Effort(NamedTuple):
    """How long a seed is refined.

    Attributes:
        iterations: Largest number of steps.
        patience: Steps after which the error must have fallen to a quarter, or the seed is left.
    """

    iterations: int
    patience: int


@leaf_kernel
def residual(
    chain: Chain, target: Target, q: Array, e: Array, w: Workspace
) -> tuple[float, float, float]:
    """Write the weighted pose error of q to ``e``, shape (6,).

    Returns:
        Distance [m], rotation angle [rad] (0 where none counts), and half the squared error.
    """
    forward_into(chain, q, w.R, w.p, w.z, w.o)
    distance, angle = pose_error(w.R, w.p, target.R, target.p, w.E, e, w.turn)
    if target.freedom.axis >= 0:
        angle = lean_error(target, e, w)
    if target.freedom.boxed:
        distance, angle = box_error(target, angle, e, w)
    weight = target.weight
    for i in range(3, 6):
        e[i] *= weight
    if not target.oriented:
        angle = 0.0
    return distance, angle, 0.5 * (distance * distance + weight * weight * angle * angle)


@leaf_kernel
def differentiate(chain: Chain, target: Target, w: Workspace) -> None:
    """Write the transposed Jacobian of the weighted error at the last :func:`residual`."""
    jacobian_into(chain, w.R, w.p, w.z, w.o, w.Jt)
    weight, Jt = target.weight, w.Jt
    if target.freedom.axis >= 0 or target.freedom.boxed:
        free_rows(target, w)
    for j in range(Jt.shape[0]):
        for i in range(3, 6):
            Jt[j, i] *= weight


@kernel
def target_error(chain: Chain, target: Target, q: Array) -> tuple[float, float]:
    """Return the distance [m] and the rotation angle [rad] of q, shape (dof,), from a target."""
    w = new_workspace(chain)
    distance, angle, _ = residual(chain, target, q, w.e, w)
    return distance, angle


# The rows are always six, so that the compiler unrolls the loops; where no orientation counts, its
# rows are zero, and the damping keeps the matrix regular.


@leaf_kernel
def normal_matrix(w: Workspace) -> None:
    """Write A = J J^T over the free joints, lower triangle."""
    A, Jt, free = w.A, w.Jt, w.free
    for i in range(6):
        for k in range(i + 1):
            A[i, k] = 0.0
    for j in range(Jt.shape[0]):
        if free[j]:
            for i in range(6):
                a = Jt[j, i]
                for k in range(i + 1):
                    A[i, k] += a * Jt[j, k]


@leaf_kernel
def solve_rows(damping: float, w: Workspace) -> None:
    """Write y = (A + damping I)^-1 y, by Cholesky."""
    A, L, y = w.A, w.L, w.y
    for i in range(6):
        for k in range(i):
            total = A[i, k]
            for j in range(k):
                total -= L[i, j] * L[k, j]
            L[i, k] = total * L[k, k]
        total = A[i, i] + damping
        for j in range(i):
            total -= L[i, j] * L[i, j]
        L[i, i] = 1.0 / math.sqrt(max(total, 1e-300))  # the inverse of the diagonal
        total = y[i]
        for j in range(i):
            total -= L[i, j] * y[j]
        y[i] = total * L[i, i]
    for back in range(6):
        i = 5 - back
        total = y[i]
        for j in range(i + 1, 6):
            total -= L[j, i] * y[j]
        y[i] = total * L[i, i]


@leaf_kernel
def _damped_step(q: Array, lower: Array, upper: Array, damping: float, w: Workspace) -> None:
    """Write the damped least-squares step to ``w.dq``; joints it would push out of limits rest."""
    Jt, y, dq, free = w.Jt, w.y, w.dq, w.free
    dof = q.shape[0]
    for j in range(dof):
        free[j] = True
    for _ in range(dof):
        normal_matrix(w)
        for i in range(6):
            y[i] = w.e[i]
        solve_rows(damping, w)
        changed = False
        for j in range(dof):
            step = 0.0
            if free[j]:
                for i in range(6):
                    step += Jt[j, i] * y[i]
                if (q[j] <= lower[j] and step < 0.0) or (q[j] >= upper[j] and step > 0.0):
                    free[j] = False
                    changed = True
            dq[j] = step
        if not changed:
            return


# At an edge of what is free a row does not count, and a step for the others leads over the edge;
# the step after leads back over theirs. Rows that counted just now are held where they are.


@leaf_kernel
def _count_those_before(w: Workspace) -> None:
    """Count the rows too that counted at the configuration before."""
    for i in range(6):
        counts = w.counts[i]
        w.counts[i] = counts or w.held[i]
        w.held[i] = counts


@leaf_kernel
def _count_again(chain: Chain, target: Target, q: Array, beyond: bool, w: Workspace) -> bool:
    """After a step that was refused: count the rows that count at q, and those at the step's end.

    Args:
        chain: The chain from base to tool.
        target: The tool pose wanted.
        q: Where the step began, shape (dof,) [rad or m].
        beyond: Whether those at its end count; without them what is held may hold up all.
        w: Buffers, as the step left them.

    Returns:
        Whether other rows count than did.
    """
    for i in range(6):
        w.held[i] = w.counts[i]
    residual(chain, target, q, w.e, w)
    other = not beyond
    for i in range(6):
        counts = w.counts[i]
        other = other or (w.held[i] and not counts)
        w.counts[i] = counts or (beyond and w.held[i])
        w.held[i] = counts
    differentiate(chain, target, w)
    return other


@leaf_kernel
def refine(
    chain: Chain,
    target: Target,
    q: Array,
    lower: Array,
    upper: Array,
    effort: Effort,
    w: Workspace,
) -> tuple[float, float, int]:
    """Bring a configuration onto its target, in place.

    Args:
        chain: The chain from base to tool.
        target: The tool pose wanted.
        q: In: seed inside the limits, out: best configuration, shape (dof,) [rad or m].
        lower: Lower position limits, shape (dof,) [rad or m].
        upper: Upper position limits, shape (dof,) [rad or m].
        effort: How long to try.
        w: Buffers of the chain.

    Returns:
        Distance [m] and rotation angle [rad] from the target, and evaluations spent.
    """
    distance, angle, error = residual(chain, target, q, w.e, w)
    evaluations = 1
    edges = target.freedom.boxed or target.freedom.cone > 0.0
    w.held[:] = False
    factor = 1.0
    rejected = 0
    checkpoint = error
    for step in range(effort.iterations):
        if error < 1e-26:
            break
        if step % effort.patience == effort.patience - 1:
            # A seed that no longer gets closer sits in a local minimum: leave it to another seed.
            if error > 0.25 * checkpoint and error > 1e-12:
                break
            checkpoint = error
        if rejected == 0:
            if edges:
                _count_those_before(w)
            differentiate(chain, target, w)
        _damped_step(q, lower, upper, factor * error + 1e-12, w)
        for j in range(q.shape[0]):
            w.trial[j] = min(max(q[j] + w.dq[j], lower[j]), upper[j])
        new_distance, new_angle, new_error = residual(chain, target, w.trial, w.e_trial, w)
        evaluations += 1
        if new_error < error:
            gain = new_error / error
            for j in range(q.shape[0]):
                q[j] = w.trial[j]
            for i in range(6):
                w.e[i] = w.e_trial[i]
            distance, angle, error = new_distance, new_angle, new_error
            rejected = 0
            if gain > 0.9 and error < 1e-20:
                break  # at the floor of rounding
            factor = max(0.2 * factor, 1e-6)
        else:
            rejected += 1
            if rejected > 6 or error < 1e-22:
                break
            if edges and (rejected == 1 or rejected == 3):
                evaluations += 1
                if _count_again(chain, target, q, rejected == 1, w):
                    continue
            factor = 10.0 * max(factor, 1e-3)
    return distance, angle, evaluations
