"""Newton-Raphson on the pose error, the reference of Li et al.

Source: [L] Li, Luo, Qiao, Machines 2023, 11(6), 648, Table 5. The paper gives the start, q = 0, and
nothing else: the step, the scale of the rotation and what happens at the joint limits are ours.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.bounds import clip
from ikplan.ik.metaheuristics.population import (
    COLD,
    Outcome,
    Problem,
    best_of,
    consider,
    draw_within,
    end_iteration,
    new_outcome,
)
from ikplan.ik.objective import ORIENTATION, WEIGHTED, objective_chain
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_into, jacobian_into, pose_error

__all__ = ["NewtonParams", "newton_raphson", "solve_least_squares"]


MILLIMETRES = 1000.0


class NewtonParams(NamedTuple):
    """Parameters of Newton-Raphson.

    Attributes:
        limits: 0 "wrap": joint limits are not looked at, angles are wrapped to (-pi, pi]; 1 "clip":
            to the limits after each step.
        damping: Added to the diagonal of J J^T (Levenberg-Marquardt) [mm^2]; 0: the pseudoinverse.
        restarts: Further starts, drawn within the limits, while the target is not met.
        length: L, what one radian of rotation error weighs [m].
        rcond: Singular values below this times the largest count as zero.
        tolerance: A start is done once the error vector is this short [mm].
    """

    limits: int
    damping: float
    restarts: int
    length: float
    rcond: float
    tolerance: float


@kernel
def _orthogonalise(U: Array, V: Array) -> None:
    """One-sided Jacobi: turn pairs of columns of U, and of V alike, until U's are orthogonal.

    With U = J^T and V = I at the start, J^T = U V^T throughout; at the end the lengths of U's
    columns are the singular values of J.
    """
    m = U.shape[1]
    for _sweep in range(30):
        turned = False
        for a in range(m - 1):
            for b in range(a + 1, m):
                aa, bb, ab = 0.0, 0.0, 0.0
                for k in range(U.shape[0]):
                    aa += U[k, a] * U[k, a]
                    bb += U[k, b] * U[k, b]
                    ab += U[k, a] * U[k, b]
                if abs(ab) <= 1e-15 * math.sqrt(aa * bb) or aa * bb == 0.0:
                    continue
                turned = True
                zeta = (bb - aa) / (2.0 * ab)
                tangent = 1.0 / (abs(zeta) + math.sqrt(1.0 + zeta * zeta))
                if zeta < 0.0:
                    tangent = -tangent
                c = 1.0 / math.sqrt(1.0 + tangent * tangent)
                s = c * tangent
                for k in range(U.shape[0]):
                    U[k, a], U[k, b] = c * U[k, a] - s * U[k, b], s * U[k, a] + c * U[k, b]
                for k in range(m):
                    V[k, a], V[k, b] = c * V[k, a] - s * V[k, b], s * V[k, a] + c * V[k, b]
        if not turned:
            return


@kernel
def solve_least_squares(Jt: Array, e: Array, damping: float, rcond: float, dq: Array) -> None:
    """Write dq = pinv(J) e, or with damping J^T (J J^T + damping I)^-1 e.

    Args:
        Jt: Transposed Jacobian, shape (D, m).
        e: Error, shape (m,).
        damping: Damping, 0 for the pseudoinverse.
        rcond: Singular values below this times the largest count as zero.
        dq: Out: step, shape (D,).
    """
    D, m = Jt.shape
    U, V, square = Jt.copy(), np.eye(m), np.zeros(m)
    _orthogonalise(U, V)
    for a in range(m):
        for k in range(D):
            square[a] += U[k, a] * U[k, a]
    least = rcond * rcond * square.max()
    dq[:] = 0.0
    for a in range(m):
        if square[a] <= least:
            continue
        along = 0.0
        for k in range(m):
            along += V[k, a] * e[k]
        for k in range(D):
            dq[k] += U[k, a] * along / (square[a] + damping)


@kernel
def _wrap(q: Array, chain: Chain) -> None:
    """Bring revolute joint values into (-pi, pi], in place."""
    if chain.coupled:
        return
    for k in range(q.shape[0]):
        if not chain.prismatic[k]:
            q[k] -= 2.0 * math.pi * math.ceil((q[k] - math.pi) / (2.0 * math.pi))


@kernel
def newton_raphson(problem: Problem, params: NewtonParams, rng: np.random.Generator) -> Outcome:
    """Solve by Newton-Raphson from q = 0, or warm from the start configuration.

    Symbols: ``e`` the pose error [mm, rad times L], ``J`` its Jacobian. An evaluation is a call of
    the forward kinematics or of the Jacobian: two an iteration. Iterations are counted over all
    starts; each start has T of them.
    """
    objective, lower, upper = problem.objective, problem.lower, problem.upper
    starts, T = params.restarts + 1, problem.iterations
    whole = Problem(
        objective,
        lower,
        upper,
        problem.q_s,
        problem.warm,
        problem.bounds,
        1,
        starts * T,
        problem.stop_value,
        problem.cut,
    )
    out = new_outcome(whole, 1)
    best = best_of(out)
    chain = objective_chain(objective)
    oriented = objective.kind == ORIENTATION or objective.kind == WEIGHTED
    m, length = 6 if oriented else 3, MILLIMETRES * params.length
    R_target, p_target = objective.target[:9].copy().reshape(3, 3), objective.target[9:].copy()
    n, D = chain.coupling.shape
    R, p, E, turn = np.empty((3, 3)), np.empty(3), np.empty((3, 3)), np.empty(3)
    z, o = np.empty((n, 3)), np.empty((n, 3))
    e, Jt, dq, q = np.empty(6), np.empty((D, 6)), np.empty(D), out.X[0]
    t = 0
    for start in range(starts):
        if start > 0:
            draw_within(lower, upper, q, rng)
        elif problem.warm == COLD:
            q[:] = 0.0
        else:
            q[:] = problem.q_s
        for step in range(T + 1):
            out.F[0] = consider(objective, q, best)
            stop = end_iteration(whole, out, t)
            forward_into(chain, q, R, p, z, o)
            pose_error(R, p, R_target, p_target, E, e, turn)
            norm = 0.0
            for i in range(m):
                e[i] *= MILLIMETRES if i < 3 else length
                norm += e[i] * e[i]
            if math.sqrt(norm) < params.tolerance or stop:
                return out
            if step == T:
                break
            jacobian_into(chain, R, p, z, o, Jt)
            best.evaluations[0] += 1
            for k in range(D):
                for i in range(m):
                    Jt[k, i] *= MILLIMETRES if i < 3 else length
            solve_least_squares(Jt[:, :m].copy(), e[:m], params.damping, params.rcond, dq)
            for k in range(D):
                q[k] += dq[k]
            if params.limits == 1:
                clip(q, lower, upper)
            else:
                _wrap(q, chain)
            t += 1
    return out
