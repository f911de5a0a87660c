"""The point of a segment, triangle or tetrahedron nearest to the origin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import leaf_kernel

__all__ = ["nearest_of_simplex"]

Array = NDArray[np.float64]


@leaf_kernel
def _dot(w: Array, i: int, j: int) -> float:
    return float(w[i, 0] * w[j, 0] + w[i, 1] * w[j, 1] + w[i, 2] * w[j, 2])


@leaf_kernel
def _on_segment(w: Array, i: int, j: int) -> tuple[float, float, float]:
    """Return the squared distance of a segment from the origin, and the weights of its ends."""
    ii, ij, jj = _dot(w, i, i), _dot(w, i, j), _dot(w, j, j)
    if ii - ij <= 0.0:
        return ii, 1.0, 0.0
    if jj - ij <= 0.0:
        return jj, 0.0, 1.0
    t = (ii - ij) / ((ii - ij) + (jj - ij))
    r = 1.0 - t
    x = r * w[i, 0] + t * w[j, 0]
    y = r * w[i, 1] + t * w[j, 1]
    z = r * w[i, 2] + t * w[j, 2]
    return x * x + y * y + z * z, r, t


@leaf_kernel
def _on_triangle(w: Array, i: int, j: int, k: int) -> tuple[float, float, float, float]:
    """Return the squared distance of a triangle from the origin, and the weights of its corners.

    The nearest point is inside where all three weights of the projection are positive; it is on
    an edge otherwise, also of a triangle without an area.
    """
    ax, ay, az = w[j, 0] - w[i, 0], w[j, 1] - w[i, 1], w[j, 2] - w[i, 2]
    bx, by, bz = w[k, 0] - w[i, 0], w[k, 1] - w[i, 1], w[k, 2] - w[i, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    nn = nx * nx + ny * ny + nz * nz
    if nn > 0.0:
        # Weights by the cross products of the corners, each with the normal.
        u = _weight(w, j, k, nx, ny, nz)
        v = _weight(w, k, i, nx, ny, nz)
        t = _weight(w, i, j, nx, ny, nz)
        whole = u + v + t
        if u > 0.0 and v > 0.0 and t > 0.0 and whole > 0.0:
            u, v = u / whole, v / whole
            t = 1.0 - u - v
            x = u * w[i, 0] + v * w[j, 0] + t * w[k, 0]
            y = u * w[i, 1] + v * w[j, 1] + t * w[k, 1]
            z = u * w[i, 2] + v * w[j, 2] + t * w[k, 2]
            if t >= 0.0:
                return x * x + y * y + z * z, u, v, t
    best, u, v = _on_segment(w, i, j)
    t = 0.0
    d, r, s = _on_segment(w, i, k)
    if d < best:
        best, u, v, t = d, r, 0.0, s
    d, r, s = _on_segment(w, j, k)
    if d < best:
        best, u, v, t = d, 0.0, r, s
    return best, u, v, t


@leaf_kernel
def _weight(w: Array, i: int, j: int, nx: float, ny: float, nz: float) -> float:
    return float(
        nx * (w[i, 1] * w[j, 2] - w[i, 2] * w[j, 1])
        + ny * (w[i, 2] * w[j, 0] - w[i, 0] * w[j, 2])
        + nz * (w[i, 0] * w[j, 1] - w[i, 1] * w[j, 0])
    )


@leaf_kernel
def _outside(w: Array, i: int, j: int, k: int, other: int) -> bool:
    """Whether a face's plane does not have the origin strictly on the side of the other corner."""
    ax, ay, az = w[j, 0] - w[i, 0], w[j, 1] - w[i, 1], w[j, 2] - w[i, 2]
    bx, by, bz = w[k, 0] - w[i, 0], w[k, 1] - w[i, 1], w[k, 2] - w[i, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    origin = -(nx * w[i, 0] + ny * w[i, 1] + nz * w[i, 2])
    inner = (
        nx * (w[other, 0] - w[i, 0]) + ny * (w[other, 1] - w[i, 1]) + nz * (w[other, 2] - w[i, 2])
    )
    return not origin * inner > 0.0


@leaf_kernel
def nearest_of_simplex(w: Array, n: int, weight: Array) -> float:
    """Find the point of a simplex nearest to the origin.

    Args:
        w: Corners, shape (4, 3); the first n count.
        n: How many, 1 to 4.
        weight: Set to the weights of the corners, shape (4,), at least 0, of sum 1.

    Returns:
        The squared distance; -1 where the origin is inside a tetrahedron.
    """
    for c in range(4):
        weight[c] = 0.0
    if n == 1:
        weight[0] = 1.0
        return _dot(w, 0, 0)
    if n == 2:
        best, u, v = _on_segment(w, 0, 1)
        weight[0], weight[1] = u, v
        return best
    if n == 3:
        best, u, v, t = _on_triangle(w, 0, 1, 2)
        weight[0], weight[1], weight[2] = u, v, t
        return best
    best = np.inf
    for other in range(4):
        i, j, k = (other + 1) % 4, (other + 2) % 4, (other + 3) % 4
        if _outside(w, i, j, k, other):
            d, u, v, t = _on_triangle(w, i, j, k)
            if d < best:
                best = d
                weight[i], weight[j], weight[k], weight[other] = u, v, t, 0.0
    return best if best < np.inf else -1.0
