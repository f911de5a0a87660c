"""The length of a joint motion."""

from __future__ import annotations

import math

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["joint_path_length"]


@kernel
def joint_path_length(q: Array, q_start: Array, start_free: bool) -> float:
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
