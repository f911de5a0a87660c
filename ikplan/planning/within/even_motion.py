"""A joint motion between two configurations, as even as the tolerance of its points allows.

The sum of the squared pose errors, in units of the tolerance, and of the squared second differences
of the joints, weighed, is made least by Gauss-Newton. Each point meets its two neighbours on either
side only: the matrix has a narrow band, and a step costs time linear in the number of points.
"""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.levenberg_marquardt import differentiate, residual
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.chain import Chain
from ikplan.planning.ladder.banded_cholesky import solve_banded
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.tracking.tracking_kernels import errors_at

__all__ = ["evened_motion"]

_ROUNDS = 3
"""Gauss-Newton steps for each weight."""


@kernel
def _assemble(
    chain: Chain, targets: Targets, q: Array, evenness: float, unit: float, A: Array, b: Array
) -> None:
    """Write the lower band of a Gauss-Newton step's matrix, and its right-hand side."""
    m, dof = q.shape
    w = new_workspace(chain)
    width = 2 * dof
    A[:] = 0.0
    for k in range(1, m - 1):
        target = target_at(targets, k)
        residual(chain, target, q[k], w.e, w)
        differentiate(chain, target, w)
        for d in range(dof):
            at = (k - 1) * dof + d
            b[at] = 0.0
            for i in range(6):
                b[at] += w.Jt[d, i] * w.e[i]
            b[at] *= unit * unit
            for j in range(d + 1):
                dot = 0.0
                for i in range(6):
                    dot += w.Jt[d, i] * w.Jt[j, i]
                A[at, width - (d - j)] = unit * unit * dot
            A[at, width] += evenness * (4.0 + (k > 1) + (k < m - 2))
            if k > 1:
                A[at, width - dof] = -4.0 * evenness
            if k > 2:
                A[at, width - 2 * dof] = evenness
            for middle in range(max(k - 1, 1), min(k + 1, m - 2) + 1):
                second = q[middle - 1, d] - 2.0 * q[middle, d] + q[middle + 1, d]
                b[at] -= evenness * second * (-2.0 if middle == k else 1.0)


@kernel
def evened_motion(
    chain: Chain,
    targets: Targets,
    q: Array,
    lower: Array,
    upper: Array,
    evenness: Array,
    position: float,
    orientation: float,
    accepted: float,
    longer: float,
) -> bool:
    """Lead the joints evenly between the first and the last configuration, in place.

    Evenness counts less and less until the errors are within the tolerance; from there on a more
    exact motion is taken as long as it is hardly longer.

    Args:
        chain: The chain from base to tool.
        targets: The targets of m points.
        q: In: a motion, out: the one found, shape (m, dof) [rad or m].
        lower: Lower position limits, shape (dof,) [rad or m].
        upper: Upper position limits, shape (dof,) [rad or m].
        evenness: What evenness weighs against the errors, one after the other, shape (k,).
        position: Tolerance [m].
        orientation: Tolerance [rad].
        accepted: Largest ratio of an error to the tolerance.
        longer: How many times as long as the first motion within the tolerance a more exact one
            may be.

    Returns:
        Whether a motion within the tolerance was found.
    """
    m, dof = q.shape
    size, width = (m - 2) * dof, 2 * dof
    A, b = np.empty((size, width + 1)), np.empty(size)
    best = q.copy()
    shortest = np.inf
    for weight in evenness:
        for _ in range(_ROUNDS):
            _assemble(chain, targets, q, weight, 1.0 / position, A, b)
            if not solve_banded(A, b, size, width):
                q[:] = best
                return shortest < np.inf
            for k in range(1, m - 1):
                for d in range(dof):
                    stepped = q[k, d] + b[(k - 1) * dof + d]
                    q[k, d] = min(max(stepped, lower[d]), upper[d])
        length = joint_path_length(q, q[0], True)
        if length > longer * shortest:
            break
        distance, angle = errors_at(chain, targets, q)
        ratio = 0.0
        for k in range(m):
            ratio = max(ratio, distance[k] / position, angle[k] / orientation)
        if ratio <= accepted:
            best[:] = q
            if shortest == np.inf:
                shortest = length
        elif shortest < np.inf:
            break
    q[:] = best
    return shortest < np.inf
