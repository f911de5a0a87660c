"""Joint values against their position limits."""

from __future__ import annotations

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["clip_inside"]


@kernel
def clip_inside(q: Array, lower: Array, upper: Array, slack: float, most: float) -> int:
    """Bring joint values onto their limits, in place, where rounding took them over.

    Args:
        q: Joint values, shape (dof,) [rad or m].
        lower: Lower position limits, shape (dof,) [rad or m].
        upper: Upper position limits, shape (dof,) [rad or m].
        slack: How far over a limit counts as rounding [rad or m].
        most: Largest value of a joint without limits [rad or m].

    Returns:
        The first joint that is farther outside, or not finite; -1 where there is none.
    """
    for k in range(q.shape[0]):
        if not (lower[k] - slack <= q[k] <= upper[k] + slack and abs(q[k]) <= most):
            return k
        q[k] = min(max(q[k], lower[k]), upper[k])
    return -1
