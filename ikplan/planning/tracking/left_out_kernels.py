"""How far places of a path are from the way of the tool, compiled."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["farthest_from_way"]


@kernel
def farthest_from_way(tool: Array, path: Array) -> tuple[Array, Array]:
    """Return how far the farthest place of each step of a path is from the tool's way over it.

    The way is taken as straight between the places where the tool is looked at.

    Args:
        tool: Positions of the tool in each step, shape (n, k, 3) [m].
        path: Places of the path in each step, shape (n, k, 3) [m].

    Returns:
        The distances, shape (n,) [m], and the largest change between two neighbouring parts of
        the way, shape (n,) [m]: by about a fifth of that the way bulges.
    """
    n, count = tool.shape[0], tool.shape[1]
    farthest, change = np.zeros(n), np.zeros(n)
    for i in range(n):
        for m in range(count):
            nearest = np.inf
            for k in range(count - 1):
                x, y, z = tool[i, k, 0], tool[i, k, 1], tool[i, k, 2]
                a, b, c = tool[i, k + 1, 0] - x, tool[i, k + 1, 1] - y, tool[i, k + 1, 2] - z
                u, v, w = path[i, m, 0] - x, path[i, m, 1] - y, path[i, m, 2] - z
                square = max(a * a + b * b + c * c, 1e-300)
                at = min(max((u * a + v * b + w * c) / square, 0.0), 1.0)
                u, v, w = u - at * a, v - at * b, w - at * c
                nearest = min(nearest, u * u + v * v + w * w)
            farthest[i] = max(farthest[i], math.sqrt(nearest))
        for k in range(count - 2):
            total = 0.0
            for j in range(3):
                step = tool[i, k + 1, j] - tool[i, k, j]
                following = tool[i, k + 2, j] - tool[i, k + 1, j]
                total += (following - step) ** 2
            change[i] = max(change[i], math.sqrt(total))
    return farthest, change
