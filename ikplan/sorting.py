"""Order of values, in kernels.

For ``np.argsort`` numba compiles its own merging anew in every process that compiles, and again
into every kernel that calls it.
"""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Indices

__all__ = ["stable_order"]


_RUN = 16
"""Values that are put in order by insertion."""


@leaf_kernel
def _is_before(a: float, b: float) -> bool:
    """Whether a value stays before one that comes after it."""
    return a <= b or b != b


@kernel
def stable_order(values: Array) -> Indices:
    """Return the indices of values, shape (n,): least value first, equal ones in order, NaN last.

    Runs of a few by insertion, these merged two by two.
    """
    n = values.shape[0]
    order, merged = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    for i in range(n):
        value, place = values[i], i
        while place % _RUN != 0 and not _is_before(values[order[place - 1]], value):
            order[place] = order[place - 1]
            place -= 1
        order[place] = i
    run = _RUN
    while run < n:
        for begin in range(0, n, 2 * run):
            left, right = begin, min(begin + run, n)
            middle, end = right, min(begin + 2 * run, n)
            for place in range(begin, end):
                if right == end or (
                    left < middle and _is_before(values[order[left]], values[order[right]])
                ):
                    merged[place] = order[left]
                    left += 1
                else:
                    merged[place] = order[right]
                    right += 1
        order, merged = merged, order
        run *= 2
    return order
