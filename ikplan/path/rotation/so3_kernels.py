"""Compiled rotations on rows: what :mod:`ikplan.path.rotation.so3` is made of.

Rotation vectors are in radians, quaternions (x, y, z, w).
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array

__all__ = [
    "add_right_jacobian",
    "exp_into",
    "exp_rows",
    "log_into",
    "log_rows",
    "matrix_into",
    "matrix_rows",
    "quaternion_rows",
]


@leaf_kernel
def exp_into(x: float, y: float, z: float, R: Array) -> None:
    """Write the rotation of the vector (x, y, z) [rad] to R, shape (3, 3): Rodrigues."""
    angle = math.sqrt(x * x + y * y + z * z)
    a, b = 1.0, 0.5
    if angle > 0.0:
        half = math.sin(0.5 * angle) / angle
        a, b = math.sin(angle) / angle, 2.0 * half * half
    R[0, 0] = 1.0 - b * (y * y + z * z)
    R[1, 1] = 1.0 - b * (x * x + z * z)
    R[2, 2] = 1.0 - b * (x * x + y * y)
    R[0, 1], R[1, 0] = b * x * y - a * z, b * x * y + a * z
    R[0, 2], R[2, 0] = b * x * z + a * y, b * x * z - a * y
    R[1, 2], R[2, 1] = b * y * z - a * x, b * y * z + a * x


@kernel
def exp_rows(rotvec: Array) -> Array:
    """Return the rotations of vectors, shape (m, 3) -> (m, 3, 3)."""
    out = np.empty((len(rotvec), 3, 3))
    for i in range(len(rotvec)):
        exp_into(rotvec[i, 0], rotvec[i, 1], rotvec[i, 2], out[i])
    return out


@leaf_kernel
def quaternion_into(M: Array, q: Array) -> None:
    """Write the unit quaternion with w >= 0 of a rotation, shape (3, 3), to q, shape (4,).

    The largest of the four components is found first and divides the others (Shepperd, 1978).
    """
    trace = M[0, 0] + M[1, 1] + M[2, 2]
    k, largest = 3, trace
    for j in range(3):
        if M[j, j] > largest:
            k, largest = j, M[j, j]
    if k == 3:
        q[0], q[1], q[2] = M[2, 1] - M[1, 2], M[0, 2] - M[2, 0], M[1, 0] - M[0, 1]
        q[3] = 1.0 + trace
    else:
        j, h = (k + 1) % 3, (k + 2) % 3
        q[k] = 1.0 + M[k, k] - M[j, j] - M[h, h]
        q[j], q[h] = M[j, k] + M[k, j], M[h, k] + M[k, h]
        q[3] = M[h, j] - M[j, h]
    norm = math.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    if q[3] < 0.0:
        norm = -norm
    for j in range(4):
        q[j] /= norm


@kernel
def quaternion_rows(R: Array) -> Array:
    """Return unit quaternions with w >= 0, shape (m, 3, 3) -> (m, 4)."""
    out = np.empty((len(R), 4))
    for i in range(len(R)):
        quaternion_into(R[i], out[i])
    return out


@leaf_kernel
def log_into(R: Array, out: Array) -> None:
    """Write the rotation vector of a rotation, shape (3, 3), to the first three of out."""
    q = out
    quaternion_into(R, q)
    sine = math.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2)
    factor = 2.0 * math.atan2(sine, q[3]) / sine if sine > 0.0 else 2.0
    for j in range(3):
        out[j] = factor * q[j]


@kernel
def log_rows(R: Array) -> Array:
    """Return the rotation vectors of rotations, shape (m, 3, 3) -> (m, 3)."""
    out, vector = np.empty((len(R), 3)), np.empty(4)
    for i in range(len(R)):
        log_into(R[i], vector)
        for j in range(3):
            out[i, j] = vector[j]
    return out


_SMALL = 1e-2
"""Angle below which power series are more exact than the closed forms [rad]."""


@leaf_kernel
def add_right_jacobian(v: Array, x: Array, inverse: bool, out: Array) -> None:
    """Add the right Jacobian at a rotation vector, or its inverse, times x to out.

    Jr(v) is the matrix by which exp(v(t)) turns at the body rate Jr(v) dv/dt.

    Args:
        v: Rotation vector, shape (3,) or more, shorter than 2 pi for the inverse [rad].
        x: Vector, shape (3,).
        inverse: Whether the inverse is meant.
        out: Vector, shape (3,).
    """
    square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    angle = math.sqrt(square)
    if inverse:
        b = 0.5
        if angle < _SMALL:
            c = 1.0 / 12.0 + square / 720.0 + square * square / 30240.0
        else:
            c = 1.0 / square - 0.5 / (angle * math.tan(0.5 * angle))
    else:
        half = math.sin(0.5 * angle) / (0.5 * angle) if angle > 0.0 else 1.0
        b = -0.5 * half * half
        if angle < _SMALL:
            c = 1.0 / 6.0 - square / 120.0 + square * square / 5040.0
        else:
            c = (angle - math.sin(angle)) / (angle * square)
    y0 = v[1] * x[2] - v[2] * x[1]
    y1 = v[2] * x[0] - v[0] * x[2]
    y2 = v[0] * x[1] - v[1] * x[0]
    out[0] += x[0] + b * y0 + c * (v[1] * y2 - v[2] * y1)
    out[1] += x[1] + b * y1 + c * (v[2] * y0 - v[0] * y2)
    out[2] += x[2] + b * y2 + c * (v[0] * y1 - v[1] * y0)


@leaf_kernel
def matrix_into(x: float, y: float, z: float, w: float, R: Array) -> None:
    """Write the rotation of a unit quaternion to R, shape (3, 3)."""
    R[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    R[0, 1] = 2.0 * (x * y - z * w)
    R[0, 2] = 2.0 * (x * z + y * w)
    R[1, 0] = 2.0 * (x * y + z * w)
    R[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    R[1, 2] = 2.0 * (y * z - x * w)
    R[2, 0] = 2.0 * (x * z - y * w)
    R[2, 1] = 2.0 * (y * z + x * w)
    R[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@kernel
def matrix_rows(quaternions: Array) -> Array:
    """Return the rotations of unit quaternions, shape (m, 4) -> (m, 3, 3)."""
    out = np.empty((len(quaternions), 3, 3))
    for i in range(len(quaternions)):
        x, y, z, w = quaternions[i]
        matrix_into(x, y, z, w, out[i])
    return out
