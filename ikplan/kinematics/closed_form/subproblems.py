"""Subproblems that the inverse kinematics of many arms is made of.

Source: A. J. Elias and J. T. Wen, "IK-Geo: Unified robot inverse kinematics using subproblem
decomposition", Mechanism and Machine Theory 209, 2025, section 3 (subproblems 1, 2 and 4; the
first is due to Paden, 1986). Vectors are tuples, so that a kernel keeps them in registers.
"""

from __future__ import annotations

import math

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array

__all__ = [
    "TANGENT",
    "Vector",
    "angle_between",
    "angles_of_projection",
    "cross",
    "dot",
    "minus",
    "plus",
    "row",
    "turned",
    "two_turns",
]

Vector = tuple[float, float, float]

TANGENT = 1e-10
"""A cosine within this of 1 counts as 1: two solutions that meet there, exact to its root."""


@leaf_kernel
def row(M: Array, i: int) -> Vector:
    """Return row i of an array of shape (n, 3)."""
    return M[i, 0], M[i, 1], M[i, 2]


@leaf_kernel
def dot(a: Vector, b: Vector) -> float:
    """Return the inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@leaf_kernel
def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@leaf_kernel
def minus(a: Vector, b: Vector) -> Vector:
    """Return the difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@leaf_kernel
def plus(a: Vector, b: Vector) -> Vector:
    """Return the sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@leaf_kernel
def turned(k: Vector, angle: float, a: Vector) -> Vector:
    """Return a vector turned about the unit vector k (Rodrigues)."""
    c, s = math.cos(angle), math.sin(angle)
    along = (1.0 - c) * dot(k, a)
    side = cross(k, a)
    return (
        c * a[0] + s * side[0] + along * k[0],
        c * a[1] + s * side[1] + along * k[1],
        c * a[2] + s * side[2] + along * k[2],
    )


@leaf_kernel
def angle_between(k: Vector, a: Vector, b: Vector) -> float:
    """Return the angle about k that turns a into b, subproblem 1 [rad].

    Of vectors that are not as long, or not as far along k, it is the angle that brings them
    nearest to each other.
    """
    return math.atan2(dot(k, cross(a, b)), dot(a, b) - dot(k, a) * dot(k, b))


@leaf_kernel
def angles_of_projection(
    h: Vector, k: Vector, a: Vector, d: float
) -> tuple[int, float, float, bool]:
    """Return the angles about k at which h . turned(k, angle, a) = d, subproblem 4.

    Returns:
        Number of angles, both angles [rad], and whether they are not well determined: any angle
        does, or two solutions meet.
    """
    sine, along = dot(h, cross(k, a)), dot(h, k) * dot(k, a)
    cosine, rest = dot(h, a) - along, d - along
    radius = math.hypot(sine, cosine)
    size = math.sqrt(dot(h, h) * dot(a, a))
    if radius <= TANGENT * size:
        return (1 if abs(rest) <= TANGENT * size else 0), 0.0, 0.0, True
    ratio = rest / radius
    middle = math.atan2(sine, cosine)
    if abs(ratio) >= 1.0 - TANGENT:
        if abs(ratio) > 1.0 + TANGENT:
            return 0, 0.0, 0.0, abs(ratio) <= 1.0 + 1e3 * TANGENT
        opening = math.acos(min(max(ratio, -1.0), 1.0))
        return 2, middle + opening, middle - opening, True
    opening = math.acos(ratio)
    return 2, middle + opening, middle - opening, False


@leaf_kernel
def two_turns(
    k: Vector, a: Vector, m: Vector, b: Vector
) -> tuple[int, float, float, float, float, bool]:
    """Return the angles with turned(k, first, a) = turned(m, second, b), subproblem 2.

    Args:
        k: Axis of the first turn.
        a: Vector that it turns.
        m: Axis of the second turn, not parallel to ``k``.
        b: Vector that it turns, as long as ``a``.

    Returns:
        Number of solutions; first and second angle of each [rad]; whether they are not well
        determined.
    """
    skew = dot(k, m)
    squared = 1.0 - skew * skew
    along_k, along_m = dot(k, a), dot(m, b)
    u = (along_k - skew * along_m) / squared
    v = (along_m - skew * along_k) / squared
    size = dot(a, a)
    rest = size - (u * u + v * v + 2.0 * u * v * skew)
    unsure = abs(rest) <= TANGENT * size
    if rest < -TANGENT * size or size == 0.0:
        return 0, 0.0, 0.0, 0.0, 0.0, size == 0.0 or rest >= -1e3 * TANGENT * size
    height = math.sqrt(max(rest, 0.0) / squared)
    n = cross(k, m)
    c = (u * k[0] + v * m[0], u * k[1] + v * m[1], u * k[2] + v * m[2])
    up = (c[0] + height * n[0], c[1] + height * n[1], c[2] + height * n[2])
    down = (c[0] - height * n[0], c[1] - height * n[1], c[2] - height * n[2])
    # A vector along an axis is turned into itself by any angle about it.
    still_a = dot(a, a) - along_k * along_k <= TANGENT * size
    still_b = dot(b, b) - along_m * along_m <= TANGENT * size
    return (
        2,
        angle_between(k, a, up),
        angle_between(m, b, up),
        angle_between(k, a, down),
        angle_between(m, b, down),
        unsure or still_a or still_b,
    )
