"""Order of a population by value."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel

__all__ = ["ascending"]


@kernel
def ascending(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the indices of ``values``, shape (n,), least value first; equal ones in order.

    By insertion: populations are small and mostly in order already.
    """
    order = np.empty(values.shape[0], dtype=np.int64)
    for i in range(values.shape[0]):
        place = i
        while place > 0 and values[order[place - 1]] > values[i]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = i
    return order
