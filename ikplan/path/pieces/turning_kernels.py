"""The compiled laws of the tool's turning; see :mod:`ikplan.path.pieces.turning`."""

from __future__ import annotations

import math
from typing import NamedTuple

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Indices
from ikplan.path.curves.arc_kernels import last_at_or_before
from ikplan.path.rotation.so3_kernels import (
    add_right_jacobian,
    exp_into,
    log_into,
    matrix_into,
)

__all__ = [
    "BLEND",
    "BY_LENGTH",
    "BY_PARAMETER",
    "EVEN",
    "HEADING",
    "NUMBERS",
    "ROW",
    "WORK",
    "TurnStack",
    "turn_into",
]


EVEN, HEADING, BLEND, BY_LENGTH, BY_PARAMETER = range(5)
"""Kinds of laws."""
NUMBERS = 24
"""Numbers of a law."""
ROW = 16
"""Numbers of a row of a law: four coefficients of a quaternion's cubic, highest power first; or of
a heading the angle and the tangent at a node."""
WORK = (6, 4, 4)
"""Shape of the scratch array."""


class TurnStack(NamedTuple):
    """Laws of turning as flat arrays: the rows of one law follow those of the one before.

    Attributes:
        kind: Kind of each, shape (l,).
        numbers: Numbers of each, shape (l, NUMBERS).
        first: Row of the first of each, and the number of rows, shape (l + 1,).
        knots: Where each row begins, shape (r,); the last row of a spline is its end.
        rows: What it needs there, shape (r, ROW).
        warp_knots: Arc length at which each row of a warp begins, shape (r,) [m].
        warp: Coefficients of the spline's parameter there, highest power first, shape (r, 6).
    """

    kind: Indices
    numbers: Array
    first: Indices
    knots: Array
    rows: Array
    warp_knots: Array
    warp: Array


@leaf_kernel
def turn_into(
    a: TurnStack,
    law: int,
    s: float,
    t: float,
    node: int,
    speed: float,
    d: Array,
    R: Array,
    w: Array,
    work: Array,
) -> None:
    """Write the rotation and the angular rate in the base at a point of a curve.

    Args:
        a: The laws.
        law: Index of the law.
        s: Arc length of the curve [m].
        t: Its own parameter.
        node: Node of the curve before the point, from 0.
        speed: |dp/dt|.
        d: Position, unit tangent and curvature vector, shape (3, 3).
        R: Out: rotation, shape (3, 3).
        w: Out: angular rate in the base, shape (3,) [rad/m].
        work: Scratch, of the shape WORK.
    """
    kind, numbers = a.kind[law], a.numbers[law]
    if kind == EVEN:
        since = s - numbers[0]
        x, y, z = since * numbers[10], since * numbers[11], since * numbers[12]
        exp_into(x, y, z, work[0])
        for i in range(3):
            rate = 0.0
            for j in range(3):
                R[i, j] = 0.0
                for k in range(3):
                    R[i, j] += numbers[1 + 3 * i + k] * work[0, k, j]
                rate += R[i, j] * numbers[10 + j]
            w[i] = rate
    elif kind == HEADING:
        _heading_into(a, law, node, d, R, w, work)
    elif kind == BLEND:
        _blend_into(numbers, t, speed, R, w, work)
    else:
        _quaternion_into(a, law, s if kind == BY_LENGTH else t, speed, R, w)


@leaf_kernel
def _heading_into(
    a: TurnStack, law: int, node: int, d: Array, R: Array, w: Array, work: Array
) -> None:
    """Turn about an axis as the direction does: numbers are R0, the axis, and the first heading."""
    numbers, row = a.numbers[law], a.rows[a.first[law] + node]
    x, y, z = numbers[9], numbers[10], numbers[11]
    u0, u1, u2, v0, v1, v2 = row[1], row[2], row[3], d[1, 0], d[1, 1], d[1, 2]
    side = (u1 * v2 - u2 * v1) * x + (u2 * v0 - u0 * v2) * y + (u0 * v1 - u1 * v0) * z
    angle = row[0] + math.atan2(side, u0 * v0 + u1 * v1 + u2 * v2) - numbers[12]
    b0, b1, b2 = d[2, 0], d[2, 1], d[2, 2]
    rate = (v1 * b2 - v2 * b1) * x + (v2 * b0 - v0 * b2) * y + (v0 * b1 - v1 * b0) * z
    exp_into(angle * x, angle * y, angle * z, work[0])
    for i in range(3):
        for j in range(3):
            R[i, j] = 0.0
            for k in range(3):
                R[i, j] += work[0, i, k] * numbers[3 * k + j]
        w[i] = rate * numbers[9 + i]


@leaf_kernel
def _blend_into(numbers: Array, t: float, speed: float, R: Array, w: Array, work: Array) -> None:
    """Go over from one even turning to another: numbers are A0, A's rate, B1, B's rate."""
    a0, a1, a2 = numbers[9], numbers[10], numbers[11]
    b0, b1, b2 = numbers[21], numbers[22], numbers[23]
    A, B, D, E = work[0], work[1], work[2], work[3]
    vectors = work[4]
    exp_into(t * a0, t * a1, t * a2, D)
    since = t - 1.0
    exp_into(since * b0, since * b1, since * b2, E)
    for i in range(3):
        for j in range(3):
            A[i, j] = B[i, j] = 0.0
            for k in range(3):
                A[i, j] += numbers[3 * i + k] * D[k, j]
                B[i, j] += numbers[12 + 3 * i + k] * E[k, j]
    for i in range(3):
        for j in range(3):
            D[i, j] = A[0, i] * B[0, j] + A[1, i] * B[1, j] + A[2, i] * B[2, j]
    gap, rate_gap, rate_E = vectors[0], vectors[1], vectors[2]
    log_into(D, gap)
    # The tool-frame rate of D = A^T B, and from it that of its logarithm.
    for i in range(3):
        rate_E[i] = numbers[21 + i] - (D[0, i] * a0 + D[1, i] * a1 + D[2, i] * a2)
        rate_gap[i] = 0.0
    add_right_jacobian(gap, rate_E, True, rate_gap)
    share = t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
    slope = 30.0 * (t * (1.0 - t)) ** 2
    turned, turning = work[5, 0], work[5, 1]
    for i in range(3):
        turned[i] = share * gap[i]
        turning[i] = slope * gap[i] + share * rate_gap[i]
    exp_into(turned[0], turned[1], turned[2], E)
    for i in range(3):
        rate_E[i] = E[0, i] * a0 + E[1, i] * a1 + E[2, i] * a2
    add_right_jacobian(turned, turning, False, rate_E)
    for i in range(3):
        w[i] = 0.0
        for j in range(3):
            R[i, j] = A[i, 0] * E[0, j] + A[i, 1] * E[1, j] + A[i, 2] * E[2, j]
            w[i] += R[i, j] * rate_E[j]
        w[i] /= speed


@leaf_kernel
def _quaternion_into(a: TurnStack, law: int, at: float, speed: float, R: Array, w: Array) -> None:
    """Turn along a spline of quaternions that is scaled to unit length.

    The first number tells whether a warp leads from arc length to the parameter of the spline.
    """
    first, end = a.first[law], a.first[law + 1] - 1
    slope = 1.0 / speed if a.kind[law] == BY_PARAMETER else 1.0
    if a.numbers[law, 0] > 0.0:
        k = min(last_at_or_before(a.warp_knots, first, end + 1, at), end - 1)
        x, c = at - a.warp_knots[k], a.warp[k]
        at = ((((c[0] * x + c[1]) * x + c[2]) * x + c[3]) * x + c[4]) * x + c[5]
        slope = (((5.0 * c[0] * x + 4.0 * c[1]) * x + 3.0 * c[2]) * x + 2.0 * c[3]) * x + c[4]
    k = min(last_at_or_before(a.knots, first, end + 1, at), end - 1)
    x, c = at - a.knots[k], a.rows[k]
    q0 = ((c[0] * x + c[4]) * x + c[8]) * x + c[12]
    q1 = ((c[1] * x + c[5]) * x + c[9]) * x + c[13]
    q2 = ((c[2] * x + c[6]) * x + c[10]) * x + c[14]
    q3 = ((c[3] * x + c[7]) * x + c[11]) * x + c[15]
    norm = math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    d0 = ((3.0 * c[0] * x + 2.0 * c[4]) * x + c[8]) * slope / norm
    d1 = ((3.0 * c[1] * x + 2.0 * c[5]) * x + c[9]) * slope / norm
    d2 = ((3.0 * c[2] * x + 2.0 * c[6]) * x + c[10]) * slope / norm
    d3 = ((3.0 * c[3] * x + 2.0 * c[7]) * x + c[11]) * slope / norm
    q0, q1, q2, q3 = q0 / norm, q1 / norm, q2 / norm, q3 / norm
    matrix_into(q0, q1, q2, q3, R)
    # Angular rate 2 dq q*, of which the part of dq along q adds only to the real part.
    w[0] = 2.0 * (q3 * d0 - d3 * q0 - (d1 * q2 - d2 * q1))
    w[1] = 2.0 * (q3 * d1 - d3 * q1 - (d2 * q0 - d0 * q2))
    w[2] = 2.0 * (q3 * d2 - d3 * q2 - (d0 * q1 - d1 * q0))
