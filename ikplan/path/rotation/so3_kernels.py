"""Compiled rotations on rows: what :mod:`ikplan.path.rotation.so3` is made of.

Rotation vectors are in radians, quaternions (x, y, z, w).
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["exp_into", "exp_rows", "log_rows", "matrix_rows", "quaternion_rows"]


@kernel
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


@kernel
def quaternion_rows(R: Array) -> Array:
    """Return unit quaternions with w >= 0, shape (m, 3, 3) -> (m, 4).

    The largest of the four components is found first and divides the others (Shepperd, 1978).
    """
    out = np.empty((len(R), 4))
    for i in range(len(R)):
        M, q = R[i], out[i]
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
    return out


@kernel
def log_rows(R: Array) -> Array:
    """Return the rotation vectors of rotations, shape (m, 3, 3) -> (m, 3)."""
    q = quaternion_rows(R)
    out = np.empty((len(R), 3))
    for i in range(len(R)):
        sine = math.sqrt(q[i, 0] ** 2 + q[i, 1] ** 2 + q[i, 2] ** 2)
        factor = 2.0 * math.atan2(sine, q[i, 3]) / sine if sine > 0.0 else 2.0
        for j in range(3):
            out[i, j] = factor * q[i, j]
    return out


@kernel
def matrix_rows(quaternions: Array) -> Array:
    """Return the rotations of unit quaternions, shape (m, 4) -> (m, 3, 3)."""
    out = np.empty((len(quaternions), 3, 3))
    for i in range(len(quaternions)):
        x, y, z, w = quaternions[i]
        out[i, 0, 0] = 1.0 - 2.0 * (y * y + z * z)
        out[i, 0, 1] = 2.0 * (x * y - z * w)
        out[i, 0, 2] = 2.0 * (x * z + y * w)
        out[i, 1, 0] = 2.0 * (x * y + z * w)
        out[i, 1, 1] = 1.0 - 2.0 * (x * x + z * z)
        out[i, 1, 2] = 2.0 * (y * z - x * w)
        out[i, 2, 0] = 2.0 * (x * z - y * w)
        out[i, 2, 1] = 2.0 * (y * z + x * w)
        out[i, 2, 2] = 1.0 - 2.0 * (x * x + y * y)
    return out
