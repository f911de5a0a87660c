"""The Newton step of path shortening: all waypoints at once, in their targets' tangent spaces.

The Hessian is block tridiagonal, so that a step costs time linear in the number of waypoints.
"""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.planning.ladder.banded_cholesky import solve_banded
from ikplan.planning.ladder.motion_cost import MotionCost
from ikplan.planning.ladder.null_space import null_space_basis

__all__ = ["newton_step"]


_AT_LIMIT = 1e-4
"""Nearer to a limit than this, a joint that is pushed out rests: cut short by the limit, its steps
would gain nothing [rad or m]."""
_SETS = 10
"""Sets of joints at their limits that a step tries."""


@kernel
def _assemble(
    u: Array,
    length: Array,
    aside: Array,
    away: Array,
    cost: MotionCost,
    basis: Array,
    rank: Indices,
    place: Indices,
    damping: float,
    row: Array,
) -> tuple[Array, Array, int]:
    """Return the band of a Newton step's matrix, its right-hand side and the width of the band.

    The matrix is the Hessian of the lengths in the tangent spaces: blocks
    W (I - u u^T) W / length, seen from both ends of a step; and those of the ways from the
    preferred ranges, in which a joint inside its range has no part.
    """
    n, dof = u.shape
    widest = 0
    for k in range(n):
        place[k + 1] = place[k] + rank[k]
        widest = max(widest, rank[k])
    size, width = int(place[n]), max(2 * widest - 1, 0)
    A, b = np.zeros((size, width + 1)), np.zeros(size)
    weights, pull = cost.weights, cost.pull / n
    for k in range(n):
        for i in range(rank[k]):
            v = basis[k, i]
            at = place[k] + i
            for d in range(dof):
                b[at] -= weights[d] * v[d] * (u[k, d] - (u[k + 1, d] if k + 1 < n else 0.0))
            if pull > 0.0 and away[k] > 0.0:
                h = pull / max(away[k], 1e-6)
                along = 0.0
                for d in range(dof):
                    b[at] -= pull * weights[d] * v[d] * aside[k, d]
                    along += weights[d] * v[d] * aside[k, d]
                for d in range(dof):
                    row[d] = 0.0
                    if aside[k, d] != 0.0:
                        row[d] = h * weights[d] * (weights[d] * v[d] - along * aside[k, d])
                for j in range(i + 1):
                    dot = 0.0
                    for d in range(dof):
                        dot += row[d] * basis[k, j, d]
                    A[at, width - (i - j)] += dot
            for side in range(2):
                m = k + side
                if m >= n:
                    continue
                h = 1.0 / max(length[m], 1e-6)
                along = 0.0
                for d in range(dof):
                    along += weights[d] * v[d] * u[m, d]
                for d in range(dof):
                    row[d] = h * weights[d] * (weights[d] * v[d] - along * u[m, d])
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
    return A, b, width


@kernel
def _moves(basis: Array, step: Array, rank: Indices, place: Indices, moves: Array) -> None:
    """Write the joint motion of each waypoint that a step is, shape (n, dof)."""
    for k in range(moves.shape[0]):
        for d in range(moves.shape[1]):
            moves[k, d] = 0.0
            for i in range(rank[k]):
                moves[k, d] += step[place[k] + i] * basis[k, i, d]


@kernel
def _turned_directions(u: Array, length: Array, weights: Array, moves: Array, out: Array) -> None:
    """Write the directions of the steps after the moves, to first order, shape (n, dof)."""
    n, dof = u.shape
    change = np.empty(dof)
    for k in range(n):
        along = 0.0
        for d in range(dof):
            change[d] = weights[d] * (moves[k, d] - (moves[k - 1, d] if k > 0 else 0.0))
            along += u[k, d] * change[d]
        h = 1.0 / max(length[k], 1e-6)
        for d in range(dof):
            out[k, d] = u[k, d] + h * (change[d] - along * u[k, d])


@kernel
def _descent(
    u: Array, aside: Array, cost: MotionCost, k: int, basis: Array, rank: int, out: Array
) -> None:
    """Write the steepest descent of waypoint k alone in the span of a basis, shape (dof,)."""
    n, dof = u.shape
    weights, pull = cost.weights, cost.pull / n
    out[:] = 0.0
    for i in range(rank):
        along = 0.0
        for d in range(dof):
            slope = u[k, d] - (u[k + 1, d] if k + 1 < n else 0.0) + pull * aside[k, d]
            along -= weights[d] * basis[i, d] * slope
        for d in range(dof):
            out[d] += along * basis[i, d]


@kernel
def newton_step(
    u: Array,
    length: Array,
    aside: Array,
    away: Array,
    q: Array,
    Jt: Array,
    lower: Array,
    upper: Array,
    cost: MotionCost,
    damping: float,
    basis: Array,
    rank: Indices,
    place: Indices,
    fixed: Flags,
) -> tuple[bool, Array]:
    """Return whether the Hessian is positive definite, and the step of all waypoints together.

    A joint at its limit is fixed where the step would push it out, and freed again where the
    descent after the step would pull it in, over and over until the set stands (a primal-dual
    active set). That fixes and frees whole runs of waypoints at once; one waypoint looked at
    by itself would let go of such a run only from its ends.

    Args:
        u: Directions of the steps into each waypoint, shape (n, dof).
        length: Their lengths, inf for a step that does not count, shape (n,) [rad or m].
        aside: Directions of the ways from the preferred ranges, shape (n, dof).
        away: Their lengths, shape (n,) [rad or m].
        q: The waypoints' configurations, shape (n, dof) [rad or m].
        Jt: Transposed Jacobians of the targets' errors, shape (n, dof, 6).
        lower: Lower position limits, shape (dof,) [rad or m].
        upper: Upper position limits, shape (dof,) [rad or m].
        cost: What the motion costs.
        damping: Added to the Hessian's diagonal.
        basis: Out: a basis of each waypoint's tangent space, shape (n, dof, dof).
        rank: Out: their dimensions, shape (n,).
        place: Out: where each waypoint's unknowns begin, shape (n + 1,).
        fixed: Out: joints that rest at a limit, shape (n, dof).
    """
    n, dof = q.shape
    fixed[:] = False
    for k in range(n):
        rank[k] = null_space_basis(Jt[k], fixed[k], basis[k])
    row, free, none = np.empty(dof), np.empty((dof, dof)), np.zeros(dof, dtype=np.bool_)
    moves, after = np.empty((n, dof)), np.empty((n, dof))
    for _ in range(_SETS):
        A, b, width = _assemble(u, length, aside, away, cost, basis, rank, place, damping, row)
        if not solve_banded(A, b, b.shape[0], width):
            return False, b
        _moves(basis, b, rank, place, moves)
        changed, known = False, False
        for k in range(n):
            renewed = False
            descended = False
            for d in range(dof):
                low, high = q[k, d] <= lower[d] + _AT_LIMIT, q[k, d] >= upper[d] - _AT_LIMIT
                if not (low or high):
                    continue
                if not fixed[k, d]:
                    if (low and moves[k, d] < -1e-12) or (high and moves[k, d] > 1e-12):
                        fixed[k, d] = True
                        renewed = True
                    continue
                if not known:
                    _turned_directions(u, length, cost.weights, moves, after)
                    known = True
                if not descended:
                    rank_free = null_space_basis(Jt[k], none, free)
                    _descent(after, aside, cost, k, free, rank_free, row)
                    descended = True
                if (low and row[d] > 1e-9) or (high and row[d] < -1e-9):
                    fixed[k, d] = False
                    renewed = True
            if renewed:
                rank[k] = null_space_basis(Jt[k], fixed[k], basis[k])
                changed = True
        if not changed:
            break
    if changed:  # the bases are no longer those of the step
        A, b, width = _assemble(u, length, aside, away, cost, basis, rank, place, damping, row)
        return solve_banded(A, b, b.shape[0], width), b
    return True, b
