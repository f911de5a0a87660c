"""Pose errors and Jacobians of many configurations at once."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.levenberg_marquardt import differentiate, residual
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.chain import Chain
from ikplan.planning.ladder.ik_candidates import Targets, target_at

__all__ = ["linearised_errors"]


@kernel
def linearised_errors(chain: Chain, targets: Targets, q: Array) -> tuple[Array, Array]:
    """Return the weighted pose error of each configuration, and its Jacobian.

    Args:
        chain: The chain from base to tool.
        targets: The targets of m points.
        q: Configurations, shape (m, dof) [rad or m].

    Returns:
        Errors e, shape (m, 6) [m, rotations weighted], and J, shape (m, 6, dof): a step dq
        leaves e - J dq.
    """
    m, dof = q.shape
    w = new_workspace(chain)
    errors, jacobians = np.empty((m, 6)), np.empty((m, 6, dof))
    for k in range(m):
        target = target_at(targets, k)
        residual(chain, target, q[k], w.e, w)
        differentiate(chain, target, w)
        for i in range(6):
            errors[k, i] = w.e[i]
            for d in range(dof):
                jacobians[k, i, d] = w.Jt[d, i]
    return errors, jacobians
