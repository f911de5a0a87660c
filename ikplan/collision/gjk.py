"""Distance of convex pieces by GJK, compiled, with bounds from both sides.

E. G. Gilbert, D. W. Johnson and S. S. Keerthi, "A fast procedure for computing the distance between
complex objects in three-dimensional space", 1988. Every support point bounds the distance from
below by a separating plane, every closest point of a simplex from above; the search ends as soon
as either answers the question asked.
"""

from __future__ import annotations

import math

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array

__all__ = ["gap_between", "support"]


_MOST_STEPS = 64
_RELATIVE = 1e-10
"""Difference of both bounds at which the search has converged, as a share of the distance."""
_TOUCHING = 1e-18
"""Squared distance that counts as none [m^2]."""


@leaf_kernel
def support(points: Array, first: int, last: int, x: float, y: float, z: float) -> int:
    """Return the index, from ``first`` to ``last - 1``, of the point farthest along (x, y, z)."""
    best, at = -math.inf, first
    for k in range(first, last):
        value = points[k, 0] * x + points[k, 1] * y + points[k, 2] * z
        if value > best:
            best, at = value, k
    return at


@leaf_kernel
def _on_line(S: Array, v: Array) -> int:
    """Closest point to the origin of the segment S[0], S[1]; see :func:`_closest`."""
    along, square = 0.0, 0.0
    for k in range(3):
        d = S[1, k] - S[0, k]
        along -= S[0, k] * d
        square += d * d
    if along <= 0.0 or square == 0.0:
        for k in range(3):
            v[k] = S[0, k]
        return 1
    if along >= square:
        for k in range(3):
            S[0, k] = S[1, k]
            v[k] = S[1, k]
        return 1
    for k in range(3):
        v[k] = S[0, k] + along / square * (S[1, k] - S[0, k])
    return 2


@leaf_kernel
def _dot(S: Array, i: int, j: int, k: int) -> float:
    """Return (S[j] - S[i]) . -S[k]."""
    return -float(
        (S[j, 0] - S[i, 0]) * S[k, 0]
        + (S[j, 1] - S[i, 1]) * S[k, 1]
        + (S[j, 2] - S[i, 2]) * S[k, 2]
    )


@leaf_kernel
def _edge(S: Array, i: int, j: int, v: Array) -> int:
    """Keep two points of a triangle and solve on their segment."""
    for k in range(3):
        a, b = S[i, k], S[j, k]
        S[0, k], S[1, k] = a, b
    return _on_line(S, v)


@leaf_kernel
def _on_triangle(S: Array, v: Array) -> int:
    """Closest point to the origin of the triangle S[0], S[1], S[2] by its Voronoi regions.

    C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
    """
    d1, d2 = _dot(S, 0, 1, 0), _dot(S, 0, 2, 0)
    d3, d4 = _dot(S, 0, 1, 1), _dot(S, 0, 2, 1)
    d5, d6 = _dot(S, 0, 1, 2), _dot(S, 0, 2, 2)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0.0 and d2 <= 0.0:
        for k in range(3):
            v[k] = S[0, k]
        return 1
    if d3 >= 0.0 and d4 <= d3:
        return _edge(S, 1, 1, v)
    if d6 >= 0.0 and d5 <= d6:
        return _edge(S, 2, 2, v)
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return _edge(S, 0, 1, v)
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return _edge(S, 0, 2, v)
    if va <= 0.0 and d4 >= d3 and d5 >= d6:
        return _edge(S, 1, 2, v)
    a0, a1, a2 = S[1, 0] - S[0, 0], S[1, 1] - S[0, 1], S[1, 2] - S[0, 2]
    b0, b1, b2 = S[2, 0] - S[0, 0], S[2, 1] - S[0, 1], S[2, 2] - S[0, 2]
    n0, n1, n2 = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    square = n0 * n0 + n1 * n1 + n2 * n2
    if square == 0.0:
        return _edge(S, 0, 1, v)
    share = (S[0, 0] * n0 + S[0, 1] * n1 + S[0, 2] * n2) / square
    v[0], v[1], v[2] = share * n0, share * n1, share * n2
    return 3


@leaf_kernel
def _outside(S: Array, i: int, j: int, k: int, apex: int) -> bool:
    """Whether the origin is on the far side of a face, or the tetrahedron is flat."""
    a0, a1, a2 = S[j, 0] - S[i, 0], S[j, 1] - S[i, 1], S[j, 2] - S[i, 2]
    b0, b1, b2 = S[k, 0] - S[i, 0], S[k, 1] - S[i, 1], S[k, 2] - S[i, 2]
    n0, n1, n2 = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    c0, c1, c2 = S[apex, 0] - S[i, 0], S[apex, 1] - S[i, 1], S[apex, 2] - S[i, 2]
    of_apex = n0 * c0 + n1 * c1 + n2 * c2
    of_origin = -(n0 * S[i, 0] + n1 * S[i, 1] + n2 * S[i, 2])
    size = math.sqrt((n0 * n0 + n1 * n1 + n2 * n2) * (c0 * c0 + c1 * c1 + c2 * c2))
    return bool(abs(of_apex) <= 1e-12 * size or of_apex * of_origin < 0.0)


@leaf_kernel
def _on_tetrahedron(S: Array, v: Array, T: Array, w: Array) -> int:
    """Closest point of a tetrahedron; 4 where the origin is inside. T, w: work space."""
    best, kept = math.inf, 4
    for face in range(4):
        i, j, k = (face + 1) % 4, (face + 2) % 4, (face + 3) % 4
        if not _outside(S, i, j, k, face):
            continue
        for c in range(3):
            T[0, c], T[1, c], T[2, c] = S[i, c], S[j, c], S[k, c]
        count = _on_triangle(T, w)
        square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
        if square < best:
            best, kept = square, count
            for c in range(3):
                v[c] = w[c]
                for r in range(3):
                    T[3 + r, c] = T[r, c]
    if kept < 4:
        for r in range(kept):
            for c in range(3):
                S[r, c] = T[3 + r, c]
    return kept


@leaf_kernel
def _closest(S: Array, count: int, v: Array, T: Array, w: Array) -> int:
    """Write the point of a simplex closest to the origin and keep the face it is on.

    Args:
        S: In, out: points of the simplex, the first ``count`` of shape (4, 3) [m].
        count: How many.
        v: Out: the closest point, shape (3,) [m].
        T: Work space, shape (6, 3).
        w: Work space, shape (3,).

    Returns:
        How many points are kept; 4: the origin is inside.
    """
    if count == 1:
        for k in range(3):
            v[k] = S[0, k]
        return 1
    if count == 2:
        return _on_line(S, v)
    if count == 3:
        return _on_triangle(S, v)
    return _on_tetrahedron(S, v, T, w)


@leaf_kernel
def _along(sweep: Array, x: float, y: float, z: float) -> float:
    """Return the most that a swept set moves along a unit vector [m]; see :func:`gap_between`."""
    if sweep[8] == 0.0:
        return 0.0
    turn_x = sweep[4] * z - sweep[5] * y
    turn_y = sweep[5] * x - sweep[3] * z
    turn_z = sweep[3] * y - sweep[4] * x
    turned = math.sqrt(turn_x * turn_x + turn_y * turn_y + turn_z * turn_z)
    straight = abs(sweep[0] * x + sweep[1] * y + sweep[2] * z) + turned * sweep[6]
    return float(min(straight + sweep[7], sweep[8]))


@leaf_kernel
def gap_between(
    points: Array,
    range_a: tuple[int, int],
    R_a: Array,
    p_a: Array,
    range_b: tuple[int, int],
    R_b: Array,
    p_b: Array,
    need: float,
    enough: float,
    sweep: Array,
    axis: Array,
    work: Array,
) -> tuple[float, float, bool]:
    """Bound the distance of the hulls of two sets of points.

    Args:
        points: All points, each set in the frame of its piece, shape (n, 3) [m].
        range_a: First and last index (exclusive) of the first set.
        R_a: Rotation of its frame, shape (3, 3).
        p_a: Origin of its frame, shape (3,) [m].
        range_b: The same of the second set.
        R_b: Rotation of its frame.
        p_b: Origin of its frame [m].
        need: The search ends once the distance is known to be larger by what the second set can
            move along the line between them [m].
        enough: The search ends once the distance is known to be at most this [m], or to be
            between the two.
        sweep: How the second set moves against the first, shape (9,): the motion of its centre and
            its turn at a constant speed, its radius about the centre, how far it deviates from
            that, and how far it moves at most.
        axis: In, out: a vector from the second set towards the first, shape (3,); where the last
            search for the pair ended is a good begin of the next.
        work: Work space, shape (12, 3).

    Returns:
        Lower and upper bound of the distance [m], 0 and 0 where they touch or overlap, a lower
        bound of 0 where the search does not converge; and whether the distance is known to be
        larger than needed.
    """
    S, T = work[0:4], work[4:10]
    v, w = work[10], work[11]
    for k in range(3):
        v[k] = axis[k]
    if v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0:
        v[0] = 1.0
    count = 0
    lower, upper = 0.0, math.inf
    for _ in range(_MOST_STEPS):
        length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        i = support(
            points, range_a[0], range_a[1],
            -(R_a[0, 0] * v[0] + R_a[1, 0] * v[1] + R_a[2, 0] * v[2]),
            -(R_a[0, 1] * v[0] + R_a[1, 1] * v[1] + R_a[2, 1] * v[2]),
            -(R_a[0, 2] * v[0] + R_a[1, 2] * v[1] + R_a[2, 2] * v[2]),
        )  # fmt: skip
        j = support(
            points, range_b[0], range_b[1],
            R_b[0, 0] * v[0] + R_b[1, 0] * v[1] + R_b[2, 0] * v[2],
            R_b[0, 1] * v[0] + R_b[1, 1] * v[1] + R_b[2, 1] * v[2],
            R_b[0, 2] * v[0] + R_b[1, 2] * v[1] + R_b[2, 2] * v[2],
        )  # fmt: skip
        along, known = 0.0, False
        for k in range(3):
            a = R_a[k, 0] * points[i, 0] + R_a[k, 1] * points[i, 1] + R_a[k, 2] * points[i, 2]
            b = R_b[k, 0] * points[j, 0] + R_b[k, 1] * points[j, 1] + R_b[k, 2] * points[j, 2]
            T[0, k] = a + p_a[k] - b - p_b[k]
            along += T[0, k] * v[k]
        bound = along / length
        moved = need + _along(sweep, v[0] / length, v[1] / length, v[2] / length)
        if bound > lower:
            lower = bound
            for k in range(3):
                axis[k] = v[k] / length
        if bound > moved:
            for k in range(3):
                axis[k] = v[k] / length
            return lower, upper, True
        if lower > enough and upper <= moved:
            return lower, upper, False
        for r in range(count):
            known = known or (T[0, 0] == S[r, 0] and T[0, 1] == S[r, 1] and T[0, 2] == S[r, 2])
        if count > 0 and (known or length - bound <= _RELATIVE * length):
            return lower, upper, False
        for k in range(3):
            S[count, k] = T[0, k]
        count = _closest(S, count + 1, v, T, w)
        square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
        if count == 4 or square <= _TOUCHING:
            return 0.0, 0.0, False
        upper = min(upper, math.sqrt(square))
        if upper <= enough or (lower > enough and upper <= moved):
            return lower, upper, False
    return 0.0, upper, False
