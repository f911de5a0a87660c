"""The distance of two convex pieces, between a proven lower and an upper bound.

The algorithm of Gilbert, Johnson and Keerthi (IEEE J. Robotics and Automation 1988) on the
corners of hulls. Each pair of support points along a direction is a separating plane, so that its
gap is a lower bound whatever the algorithm does next; each point of the simplex is the difference
of two points of the bodies, so that its length is an upper bound.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import leaf_kernel
from ikplan.certificate.clearance.simplex import nearest_of_simplex

__all__ = ["Scratch", "farthest", "piece_distance", "scratch"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_GAP = 1e-9
"""Upper and lower bound this near to each other are the distance [m]."""
_TOUCHING = 1e-12
"""Hulls this near to each other touch [m]."""
_STEPS = 100
"""Most steps of a query; what it then knows is still proven."""


class Scratch(NamedTuple):
    """Space of the kernel, and the points it found.

    Attributes:
        w: Corners of the simplex, shape (4, 3).
        a: Their points on the first hull, shape (4, 3).
        b: Their points on the second hull, shape (4, 3).
        ids: Indices of those points, shape (4, 2).
        weight: Weights of the corners, shape (4,).
        nearest: Points of the two hulls at the upper bound, shape (2, 3), in the common frame.
    """

    w: Array
    a: Array
    b: Array
    ids: Ints
    weight: Array
    nearest: Array


def scratch() -> Scratch:
    """Return space for :func:`piece_distance`."""
    w, a, b = np.zeros((4, 3)), np.zeros((4, 3)), np.zeros((4, 3))
    ids = np.zeros((4, 2), dtype=np.int64)
    return Scratch(w, a, b, ids, np.zeros(4), np.zeros((2, 3)))


@leaf_kernel
def farthest(xyz: Array, begin: int, end: int, x: float, y: float, z: float) -> int:
    """Return which of the points begin..end is the farthest along a direction.

    Args:
        xyz: Points by coordinate, shape (3, n).
        begin: First point.
        end: One after the last.
        x: The direction's x; with y and z.
        y: Its y.
        z: Its z.
    """
    best0 = best1 = best2 = best3 = -np.inf
    k0 = k1 = k2 = k3 = begin
    i = begin
    # Four running maxima, since each compare waits for the one before.
    while i + 3 < end:
        s0 = x * xyz[0, i] + y * xyz[1, i] + z * xyz[2, i]
        s1 = x * xyz[0, i + 1] + y * xyz[1, i + 1] + z * xyz[2, i + 1]
        s2 = x * xyz[0, i + 2] + y * xyz[1, i + 2] + z * xyz[2, i + 2]
        s3 = x * xyz[0, i + 3] + y * xyz[1, i + 3] + z * xyz[2, i + 3]
        if s0 > best0:
            best0, k0 = s0, i
        if s1 > best1:
            best1, k1 = s1, i + 1
        if s2 > best2:
            best2, k2 = s2, i + 2
        if s3 > best3:
            best3, k3 = s3, i + 3
        i += 4
    while i < end:
        s0 = x * xyz[0, i] + y * xyz[1, i] + z * xyz[2, i]
        if s0 > best0:
            best0, k0 = s0, i
        i += 1
    if best1 > best0:
        best0, k0 = best1, k1
    if best3 > best2:
        best2, k2 = best3, k3
    return k2 if best2 > best0 else k0


@leaf_kernel
def _support(
    xyz: Array, begin: int, end: int, R: Array, p: Array, c: int, v: Array, sign: float,
    found: Array, n: int,
) -> int:  # fmt: skip
    """Write the point of a hull carried by c farthest along sign * v to row n of found."""
    x = sign * (R[c, 0, 0] * v[0] + R[c, 1, 0] * v[1] + R[c, 2, 0] * v[2])
    y = sign * (R[c, 0, 1] * v[0] + R[c, 1, 1] * v[1] + R[c, 2, 1] * v[2])
    z = sign * (R[c, 0, 2] * v[0] + R[c, 1, 2] * v[1] + R[c, 2, 2] * v[2])
    k = farthest(xyz, begin, end, x, y, z)
    for r in range(3):
        found[n, r] = (
            R[c, r, 0] * xyz[0, k] + R[c, r, 1] * xyz[1, k] + R[c, r, 2] * xyz[2, k] + p[c, r]
        )
    return k


@leaf_kernel
def piece_distance(
    xyz: Array, start: Ints, i: int, j: int, R: Array, p: Array, ci: int, cj: int,
    needed: float, enough: float, v: Array, space: Scratch,
) -> tuple[float, float]:  # fmt: skip
    """Bound the distance between the hulls of two pieces, their radii left out.

    Args:
        xyz: Corners of every piece, by coordinate, shape (3, n) [m], in their carriers' frames.
        start: Where the corners of each piece begin, shape (pieces + 1,).
        i: First piece.
        j: Second piece.
        R: Rotations of the carriers, shape (m, 3, 3).
        p: Their origins, shape (m, 3) [m].
        ci: Carrier of the first piece.
        cj: Carrier of the second.
        needed: A lower bound above it is enough to know [m].
        enough: An upper bound up to it is enough to know [m].
        v: Where to begin, a direction from the second piece to the first, shape (3,), of any
            length but 0; set to the last one, for a query nearby.
        space: Space; ``space.nearest`` is set to the two points at the upper bound.

    Returns:
        Lower and upper bound [m]. The hulls touch, or may, where the lower one is not above 0.
    """
    w, ids, weight = space.w, space.ids, space.weight
    lower, upper = -np.inf, np.inf
    n = 0
    for _ in range(_STEPS):
        length = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        ka = _support(xyz, start[i], start[i + 1], R, p, ci, v, -1.0, space.a, n)
        kb = _support(xyz, start[j], start[j + 1], R, p, cj, v, 1.0, space.b, n)
        for r in range(3):
            w[n, r] = space.a[n, r] - space.b[n, r]
        lower = max(lower, (v[0] * w[n, 0] + v[1] * w[n, 1] + v[2] * w[n, 2]) / length)
        if upper == np.inf:
            # The first pair of points is one of the two bodies in any case.
            upper = np.sqrt(w[n, 0] ** 2 + w[n, 1] ** 2 + w[n, 2] ** 2)
            for r in range(3):
                space.nearest[0, r], space.nearest[1, r] = space.a[n, r], space.b[n, r]
            first = True
        else:
            first = False
        if lower > needed or upper <= enough or upper - lower <= _GAP:
            break
        known = False
        for c in range(n):
            known = known or (ids[c, 0] == ka and ids[c, 1] == kb)
        if known:
            break
        ids[n, 0], ids[n, 1] = ka, kb
        n += 1
        squared = nearest_of_simplex(w, n, weight)
        if squared <= _TOUCHING * _TOUCHING:
            _combine(n, space)
            return min(lower, 0.0), 0.0
        if not first and not squared < upper * upper:
            break
        upper = min(upper, np.sqrt(squared))
        n = _reduce(n, space)
        _combine(n, space)
        for r in range(3):
            v[r] = space.nearest[0, r] - space.nearest[1, r]
        if upper <= enough:
            break
    return min(lower, upper), upper


@leaf_kernel
def _combine(n: int, space: Scratch) -> None:
    for r in range(3):
        on_a = on_b = 0.0
        for c in range(n):
            on_a += space.weight[c] * space.a[c, r]
            on_b += space.weight[c] * space.b[c, r]
        space.nearest[0, r], space.nearest[1, r] = on_a, on_b


@leaf_kernel
def _reduce(n: int, space: Scratch) -> int:
    """Drop the corners without a weight; return how many are left."""
    kept = 0
    for c in range(n):
        if space.weight[c] > 0.0:
            if kept != c:
                for r in range(3):
                    space.w[kept, r] = space.w[c, r]
                    space.a[kept, r] = space.a[c, r]
                    space.b[kept, r] = space.b[c, r]
                space.ids[kept, 0], space.ids[kept, 1] = space.ids[c, 0], space.ids[c, 1]
                space.weight[kept] = space.weight[c]
            kept += 1
    return kept
