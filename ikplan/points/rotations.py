"""Orientations as people write them, turned into unit quaternions (x, y, z, w).

Plain Python: a client without numpy reads points too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["axis_quaternion", "fixed_axes", "quaternion_product", "rotation_vector", "shortest_arc"]

Quaternion = list[float]

_UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def quaternion_product(a: Sequence[float], b: Sequence[float]) -> Quaternion:
    """Return the quaternion of the rotation matrix product R(a) R(b)."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]


def _about(axis: str, angle: float) -> Quaternion:
    half = 0.5 * angle
    return [*(c * math.sin(half) for c in _UNIT[axis]), math.cos(half)]


def fixed_axes(x: float, y: float, z: float) -> Quaternion:
    """Return R_z(z) R_y(y) R_x(x): turns about the fixed axes x, y and z in this order [rad].

    The same as turns about z, the turned y and the twice turned x, in that order.
    """
    turned = quaternion_product(_about("z", z), _about("y", y))
    return quaternion_product(turned, _about("x", x))


def rotation_vector(x: float, y: float, z: float) -> Quaternion:
    """Return the turn about a vector by its length [rad]."""
    angle = math.hypot(x, y, z)
    # sin(angle / 2) / angle; its limit where the vector has no length.
    scale = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.5
    return [scale * x, scale * y, scale * z, math.cos(0.5 * angle)]


def shortest_arc(a: Sequence[float], b: Sequence[float]) -> Quaternion:
    """Return the shortest turn from the direction of one unit vector to that of another.

    Between opposite vectors it turns about an axis across them, the same one every time.
    """
    dot = sum(p * q for p, q in zip(a, b, strict=True))
    cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    sine = math.hypot(*cross)
    if sine < 1e-12 and dot < 0.0:
        least = min(range(3), key=lambda k: abs(a[k]))
        across = [a[k] * -a[least] + (1.0 if k == least else 0.0) for k in range(3)]
        length = math.hypot(*across)
        return [*(c / length for c in across), 0.0]
    angle = math.atan2(sine, dot)
    scale = math.sin(0.5 * angle) / sine if sine > 0.0 else 0.0
    return [*(scale * c for c in cross), math.cos(0.5 * angle)]


def axis_quaternion(
    axis: str, direction: Sequence[float], before: Sequence[float] | None = None
) -> Quaternion:
    """Return an orientation whose axis points in a direction.

    Args:
        axis: ``"x"``, ``"y"`` or ``"z"``, or one with a minus for the opposite of that axis.
        direction: A unit vector.
        before: The orientation to get there from without a turn about the axis; None: identity.

    Returns:
        The orientation nearest to ``before``.
    """
    sign = -1.0 if axis.startswith("-") else 1.0
    start = list(before) if before is not None else [0.0, 0.0, 0.0, 1.0]
    x, y, z, w = start
    columns = {
        "x": (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        "y": (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
        "z": (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)),
    }
    now = [sign * c for c in columns[axis[-1]]]
    turned = quaternion_product(shortest_arc(now, direction), start)
    norm = math.hypot(*turned)
    return [c / norm for c in turned]
