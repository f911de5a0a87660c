"""Where a motion on a grid switches from speeding up to slowing down, between two nodes."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices

__all__ = ["switch_points"]

_INSIDE = 1e-3
"""How far from both ends of its interval a switching point lies, as a share of the interval."""


@kernel
def switch_points(
    s: Array, x: Array, loss: Array, ends: Indices, share: float, least: float
) -> Array:
    """Return the path positions at which the acceleration along the path jumps down.

    Between two nodes the acceleration is constant. One that lies between those of both its
    neighbours is their mean about a point where the one would end and the other begin.

    Args:
        s: Nodes, shape (n + 1,).
        x: Squared path velocities at the nodes, shape (n + 1,).
        loss: What each interval takes longer than on a fine grid [s], shape (n,).
        ends: First interval of each span from rest to rest, and n, shape (r + 1,).
        share: Least part of the loss of its span that such an interval has.
        least: Least loss of such an interval [s].

    Returns:
        Positions, strictly increasing, none of them a node.
    """
    found = np.empty(len(loss))
    count = 0
    for span in range(len(ends) - 1):
        first, last = ends[span], ends[span + 1]
        total = 0.0
        for i in range(first, last):
            total += loss[i]
        for i in range(first + 1, last - 1):
            if not (loss[i] > share * total and loss[i] > least):
                continue
            h = s[i + 1] - s[i]
            before = (x[i] - x[i - 1]) / (s[i] - s[i - 1])
            after = (x[i + 2] - x[i + 1]) / (s[i + 2] - s[i + 1])
            here = (x[i + 1] - x[i]) / h
            if before > here > after:
                along = (x[i + 1] - x[i] - after * h) / (before - after)
                if _INSIDE * h < along < (1.0 - _INSIDE) * h:
                    found[count] = s[i] + along
                    count += 1
    return found[:count].copy()
