"""The joint motions that keep a target: the tangent space of its solution set."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags
from ikplan.copying import copy_into

__all__ = ["null_space_basis"]


@kernel
def null_space_basis(Jt: Array, fixed: Flags, basis: Array) -> int:
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
            copy_into(basis[count], span[rank])
            count += 1
        rank += 1
    return count
