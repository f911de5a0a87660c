"""The buffers that a solve works in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags
from ikplan.kinematics.chain import Chain

__all__ = ["Workspace", "new_workspace"]


class Workspace(NamedTuple):
    """Buffers of a solve.

    Attributes:
        R: Rotation of the tool, shape (3, 3).
        p: Position of the tool, shape (3,).
        z: Joint axes, shape (n, 3).
        o: Joint origins, shape (n, 3).
        E: Rotation from the tool to the target, shape (3, 3).
        turn: Its rotation vector, shape (3,).
        e: Error of the current configuration, shape (6,).
        e_trial: Error of the trial, shape (6,).
        Jt: Transposed Jacobian, shape (dof, 6).
        A: Normal matrix, shape (6, 6).
        L: Its Cholesky factor, shape (6, 6).
        y: Right-hand side and solution, shape (6,).
        dq: Step, shape (dof,).
        free: Which joints move, shape (dof,).
        trial: Trial configuration, shape (dof,).
        counts: Which rows of the error count at the last residual, shape (6,).
        held: Which rows counted at another configuration, shape (6,).
        turned: Whether its rows are along the box's axes instead of the tool's, shape (1,).
    """

    R: Array
    p: Array
    z: Array
    o: Array
    E: Array
    turn: Array
    e: Array
    e_trial: Array
    Jt: Array
    A: Array
    L: Array
    y: Array
    dq: Array
    free: Flags
    trial: Array
    counts: Flags
    held: Flags
    turned: Flags


@kernel
def new_workspace(chain: Chain) -> Workspace:
    """Return the buffers for a chain."""
    n, dof = chain.coupling.shape
    return Workspace(
        np.empty((3, 3)),
        np.empty(3),
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty((3, 3)),
        np.empty(3),
        np.zeros(6),
        np.zeros(6),
        np.empty((dof, 6)),
        np.empty((6, 6)),
        np.empty((6, 6)),
        np.empty(6),
        np.empty(dof),
        np.empty(dof, dtype=np.bool_),
        np.empty(dof),
        np.ones(6, dtype=np.bool_),
        np.ones(6, dtype=np.bool_),
        np.zeros(1, dtype=np.bool_),
    )
