"""Order of a population by value."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.sorting import stable_order

__all__ = ["ascending"]

MERGED = 500
"""More values than this are sorted by merging."""


@kernel
def ascending(values: Array) -> Indices:
    """Return the indices of ``values``, shape (n,), least value first; equal ones in order.

    By insertion: populations are small and mostly in order already. Large ones are merged, to the
    same order.
    """
    if values.shape[0] > MERGED:
        return stable_order(values)
    order = np.empty(values.shape[0], dtype=np.int64)
    for i in range(values.shape[0]):
        place = i
        while place > 0 and values[order[place - 1]] > values[i]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = i
    return order
