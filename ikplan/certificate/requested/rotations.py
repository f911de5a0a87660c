"""Rotations for the certificate, in plain numpy.

Rotation vectors are in radians, quaternions (x, y, z, w), stacks on the first axis. Formulas:
Rodrigues for the exponential; Shepperd, Quaternion from rotation matrix (1978), for the way back.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array, length_of

__all__ = [
    "angle_between",
    "exp",
    "log",
    "quaternions_of",
    "rotation_between",
    "rotation_of",
    "rotations_of",
    "unit",
]


def unit(vector: Array | Sequence[float]) -> Array:
    """Return vectors, shape (..., 3) or (..., 4), scaled to length 1."""
    v = np.asarray(vector, dtype=np.float64)
    return np.asarray(v / np.sqrt((v * v).sum(axis=-1, keepdims=True)))


def exp(rotvec: Array) -> Array:
    """Return the rotations about vectors, shape (m, 3), by their lengths, shape (m, 3, 3)."""
    angle = np.sqrt((rotvec * rotvec).sum(axis=1))
    half_sinc = np.sinc(angle / (2.0 * np.pi))
    a, b = np.sinc(angle / np.pi), 0.5 * half_sinc * half_sinc
    x, y, z = rotvec.T
    R = np.empty((len(rotvec), 3, 3))
    bx, by, bz = b * x, b * y, b * z
    ax, ay, az = a * x, a * y, a * z
    R[:, 0, 0] = 1.0 - by * y - bz * z
    R[:, 1, 1] = 1.0 - bx * x - bz * z
    R[:, 2, 2] = 1.0 - bx * x - by * y
    R[:, 0, 1], R[:, 1, 0] = bx * y - az, bx * y + az
    R[:, 0, 2], R[:, 2, 0] = bx * z + ay, bx * z - ay
    R[:, 1, 2], R[:, 2, 1] = by * z - ax, by * z + ax
    return R


def rotation_of(quaternion_xyzw: Sequence[float]) -> Array:
    """Return the rotation matrix of one quaternion, scaled to length 1, shape (3, 3)."""
    x, y, z, w = quaternion_xyzw
    two = 2.0 / (x * x + y * y + z * z + w * w)
    return np.array(
        [
            [1.0 - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)],
            [two * (x * y + w * z), 1.0 - two * (x * x + z * z), two * (y * z - w * x)],
            [two * (x * z - w * y), two * (y * z + w * x), 1.0 - two * (x * x + y * y)],
        ]
    )


def rotations_of(quaternions: Array) -> Array:
    """Return the rotation matrices of quaternions, shape (m, 4), scaled to length 1."""
    x, y, z, w = unit(quaternions).T
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    wx, wy, wz = w * x, w * y, w * z
    rows = [
        [1.0 - 2.0 * (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy)],
        [2.0 * (xy + wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz - wx)],
        [2.0 * (xz - wy), 2.0 * (yz + wx), 1.0 - 2.0 * (xx + yy)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def quaternions_of(R: Array) -> Array:
    """Return unit quaternions of rotations, shape (m, 3, 3), with w >= 0, shape (m, 4)."""
    xx, yy, zz = R[:, 0, 0], R[:, 1, 1], R[:, 2, 2]
    # Four times the products of the components: row i is the quaternion times its component i.
    rows = np.empty((len(R), 4, 4))
    rows[:, 0, 0], rows[:, 1, 1] = 1.0 + xx - yy - zz, 1.0 - xx + yy - zz
    rows[:, 2, 2], rows[:, 3, 3] = 1.0 - xx - yy + zz, 1.0 + xx + yy + zz
    rows[:, 0, 1] = rows[:, 1, 0] = R[:, 0, 1] + R[:, 1, 0]
    rows[:, 0, 2] = rows[:, 2, 0] = R[:, 0, 2] + R[:, 2, 0]
    rows[:, 1, 2] = rows[:, 2, 1] = R[:, 1, 2] + R[:, 2, 1]
    rows[:, 0, 3] = rows[:, 3, 0] = R[:, 2, 1] - R[:, 1, 2]
    rows[:, 1, 3] = rows[:, 3, 1] = R[:, 0, 2] - R[:, 2, 0]
    rows[:, 2, 3] = rows[:, 3, 2] = R[:, 1, 0] - R[:, 0, 1]
    largest = np.argmax(np.einsum("mii->mi", rows), axis=1)
    q = unit(rows[np.arange(len(R)), largest])
    return np.asarray(np.where(q[:, 3:] < 0.0, -q, q))


def log(R: Array) -> Array:
    """Return the rotation vectors of rotations, shape (m, 3, 3), of lengths up to pi, (m, 3)."""
    q = quaternions_of(R)
    v = q[:, :3]
    sine = np.sqrt((v * v).sum(axis=1))
    angle = 2.0 * np.arctan2(sine, q[:, 3])
    scale = np.where(sine > 1e-150, angle / np.where(sine > 1e-150, sine, 1.0), 2.0)
    return np.asarray(v * scale[:, None])


def rotation_between(A: Array, B: Array) -> Array:
    """Return the rotation vector, in the frame of A, that turns A to B, shape (3,)."""
    return np.asarray(log((A.T @ B)[None])[0])


def angle_between(A: Array, B: Array) -> float:
    """Return the angle of the rotation from A to B [rad]."""
    return length_of(rotation_between(A, B))
