"""How far joints and bodies can be from where they are at one instant of an interval."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import leaf_kernel
from ikplan.certificate.clearance.chain import JointChain

__all__ = ["joint_ranges", "joint_values", "motion_bounds"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@leaf_kernel
def _blossom(c: Array, k: int, j: int, x: float, y: float, z: float) -> float:
    """Return the polar form of the cubic of piece k and joint j."""
    a = c[k, 0, j] + x * (c[k, 1, j] - c[k, 0, j])
    b = c[k, 1, j] + x * (c[k, 2, j] - c[k, 1, j])
    d = c[k, 2, j] + x * (c[k, 3, j] - c[k, 2, j])
    a += y * (b - a)
    b += y * (d - b)
    return float(a + z * (b - a))


@leaf_kernel
def joint_values(controls: Array, u: float, q: Array) -> None:
    """Evaluate a curve.

    Args:
        controls: Bezier control values, shape (n, 4, m) [rad or m].
        u: The parameter, 0 to n.
        q: Set to the joint values, shape (m,).
    """
    k = min(int(u), controls.shape[0] - 1)
    x = u - k
    for j in range(controls.shape[2]):
        q[j] = _blossom(controls, k, j, x, x, x)


@leaf_kernel
def joint_ranges(
    controls: Array, low: Array, high: Array, a: float, b: float, q: Array, delta: Array
) -> None:
    """Bound how far each joint is from a value in an interval of the parameter.

    Args:
        controls: Bezier control values, shape (n, 4, m) [rad or m].
        low: Least control value of each piece, shape (n, m).
        high: Greatest, shape (n, m).
        a: Where the interval begins.
        b: Where it ends.
        q: The values, shape (m,).
        delta: Set to the bounds, shape (m,): the curve is in the hull of its control values.
    """
    m = controls.shape[2]
    # The end of the motion belongs to its last piece: a part may have no length there.
    first = min(int(a), controls.shape[0] - 1)
    last = max(min(int(np.ceil(b)), controls.shape[0]), first + 1)
    for j in range(m):
        delta[j] = 0.0
    for k in range(first, last):
        x, y = max(a - k, 0.0), min(b - k, 1.0)
        if x == 0.0 and y == 1.0:
            for j in range(m):
                delta[j] = max(delta[j], q[j] - low[k, j], high[k, j] - q[j])
        else:
            for j in range(m):
                c0 = abs(_blossom(controls, k, j, x, x, x) - q[j])
                c1 = abs(_blossom(controls, k, j, x, x, y) - q[j])
                c2 = abs(_blossom(controls, k, j, x, y, y) - q[j])
                c3 = abs(_blossom(controls, k, j, y, y, y) - q[j])
                delta[j] = max(delta[j], c0, c1, c2, c3)


@leaf_kernel
def motion_bounds(
    chain: JointChain, R: Array, p: Array, delta: Array, carrier: Ints, centre: Array,
    size: Array, bound: Array,
) -> None:  # fmt: skip
    """Bound how far a point of each piece can move against every joint before its own.

    The motion is a product of rotations and shifts about the axes as they are at the middle
    configuration. From the piece to the base, each joint moves a point by at most its own change
    times the point's distance from the axis: the piece's at the middle configuration, and as far
    as the joints behind it have moved the point already.

    Args:
        chain: The joints.
        R: Rotations of the carriers at the middle configuration, shape (n + 1, 3, 3).
        p: Their origins, shape (n + 1, 3) [m].
        delta: Largest change of each joint from there, shape (n,) [rad or m].
        carrier: Carrier of each piece, shape (pieces,).
        centre: Centres of their bounding spheres there, shape (pieces, 3) [m].
        size: Radii of those spheres around the hulls, shape (pieces,) [m].
        bound: Set to the bounds [m], shape (pieces, n + 1): column k for carrier k.
    """
    for i in range(carrier.shape[0]):
        moved = 0.0
        for k in range(carrier[i] - 1, -1, -1):
            if chain.slides[k]:
                moved += delta[k]
            else:
                ax, ay, az = chain.axis[k, 0], chain.axis[k, 1], chain.axis[k, 2]
                x = R[k + 1, 0, 0] * ax + R[k + 1, 0, 1] * ay + R[k + 1, 0, 2] * az
                y = R[k + 1, 1, 0] * ax + R[k + 1, 1, 1] * ay + R[k + 1, 1, 2] * az
                z = R[k + 1, 2, 0] * ax + R[k + 1, 2, 1] * ay + R[k + 1, 2, 2] * az
                rx, ry, rz = (
                    centre[i, 0] - p[k + 1, 0],
                    centre[i, 1] - p[k + 1, 1],
                    centre[i, 2] - p[k + 1, 2],
                )
                cx, cy, cz = ry * z - rz * y, rz * x - rx * z, rx * y - ry * x
                reach = np.sqrt(cx * cx + cy * cy + cz * cz) + size[i]
                # A chord is no longer than its arc, nor than two radii.
                moved += min(delta[k], 2.0) * (reach + moved)
            bound[i, k] = moved
