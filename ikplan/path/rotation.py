"""Rotations: exponential and logarithm on SO(3), their Jacobians, quaternions.

Rotation vectors are in radians, quaternions (x, y, z, w). Every function takes stacks of rotations
on leading axes. Formulas: Sola, Deray, Atchuthan, A micro Lie theory for state estimation in
robotics (2018), appendix B.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "angle_between",
    "cross_matrix",
    "exp",
    "log",
    "quaternion_of",
    "right_jacobian",
    "right_jacobian_inverse",
    "rotation_of",
]

Array = NDArray[np.float64]

_SMALL = 1e-2
"""Angle below which power series are more exact than the closed forms [rad]."""


def rotation_of(quaternion_xyzw: Sequence[float] | Array) -> Array:
    """Return the rotation matrix of unit quaternions (x, y, z, w), shape (..., 3, 3)."""
    x, y, z, w = np.moveaxis(np.asarray(quaternion_xyzw, dtype=np.float64), -1, 0)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quaternion_of(R: Array) -> Array:
    """Return the unit quaternions (x, y, z, w) of rotation matrices, shape (..., 4), w >= 0.

    The largest of the four components is found first and divides the others (Shepperd, 1978).
    """
    R = np.asarray(R, dtype=np.float64)
    flat = R.reshape(-1, 3, 3)
    trace = np.trace(flat, axis1=1, axis2=2)
    diagonal = np.stack([flat[:, 0, 0], flat[:, 1, 1], flat[:, 2, 2], trace], axis=1)
    largest = np.argmax(diagonal, axis=1)
    quaternions = np.empty((len(flat), 4))
    for k in range(4):
        rows = largest == k
        if not rows.any():
            continue
        M = flat[rows]
        q = np.empty((len(M), 4))
        if k == 3:
            q[:, :3] = _vee(M)
            q[:, 3] = 1.0 + trace[rows]
        else:
            i, j, h = k, (k + 1) % 3, (k + 2) % 3
            q[:, i] = 1.0 + M[:, i, i] - M[:, j, j] - M[:, h, h]
            q[:, j] = M[:, j, i] + M[:, i, j]
            q[:, h] = M[:, h, i] + M[:, i, h]
            q[:, 3] = M[:, h, j] - M[:, j, h]
        quaternions[rows] = q / np.linalg.norm(q, axis=1)[:, None]
    quaternions[quaternions[:, 3] < 0.0] *= -1.0
    return quaternions.reshape(*R.shape[:-2], 4)


def _vee(M: Array) -> Array:
    """The vector of twice the skew part of M, shape (..., 3)."""
    return np.stack(
        [
            M[..., 2, 1] - M[..., 1, 2],
            M[..., 0, 2] - M[..., 2, 0],
            M[..., 1, 0] - M[..., 0, 1],
        ],
        axis=-1,
    )


def cross_matrix(v: Array) -> Array:
    """Return [v]x with [v]x u = v x u, shape (..., 3, 3)."""
    v = np.asarray(v, dtype=np.float64)
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    o = np.zeros_like(x)
    rows = [[o, -z, y], [z, o, -x], [-y, x, o]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def exp(rotvec: Array) -> Array:
    """Return the rotation about ``rotvec`` by its length [rad], shape (..., 3, 3)."""
    K = cross_matrix(rotvec)
    angle = np.linalg.norm(rotvec, axis=-1)[..., None, None]
    a = np.sinc(angle / np.pi)
    b = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    rotation: Array = np.eye(3) + a * K + b * (K @ K)
    return rotation


def log(R: Array) -> Array:
    """Return the rotation vector of R, shape (..., 3), of length <= pi [rad].

    Exact near 0 and near pi. At exactly pi one of the two answers is given, always the same.
    """
    q = quaternion_of(R)
    sine = np.linalg.norm(q[..., :3], axis=-1)
    angle = 2.0 * np.arctan2(sine, q[..., 3])
    factor = np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 2.0)
    rotvec: Array = factor[..., None] * q[..., :3]
    return rotvec


def angle_between(A: Array, B: Array) -> Array:
    """Return the angle of the rotation from A to B, shape (...) [rad]."""
    return np.asarray(np.linalg.norm(log(np.swapaxes(A, -1, -2) @ B), axis=-1))


def right_jacobian(rotvec: Array) -> Array:
    """Return Jr with the body rate of exp(rotvec(t)) being Jr(rotvec) d rotvec/dt, (..., 3, 3)."""
    K = cross_matrix(rotvec)
    angle = np.linalg.norm(rotvec, axis=-1)[..., None, None]
    safe = np.where(angle < _SMALL, 1.0, angle)
    square = angle * angle
    b = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    series = 1.0 / 6.0 - square / 120.0 + square**2 / 5040.0
    c = np.where(angle < _SMALL, series, (safe - np.sin(safe)) / safe**3)
    jacobian: Array = np.eye(3) - b * K + c * (K @ K)
    return jacobian


def right_jacobian_inverse(rotvec: Array) -> Array:
    """Return the inverse of :func:`right_jacobian`, for angles below 2 pi, shape (..., 3, 3)."""
    K = cross_matrix(rotvec)
    angle = np.linalg.norm(rotvec, axis=-1)[..., None, None]
    safe = np.where(angle < _SMALL, 1.0, angle)
    square = angle * angle
    series = 1.0 / 12.0 + square / 720.0 + square**2 / 30240.0
    closed = 1.0 / safe**2 - 0.5 / (safe * np.tan(0.5 * safe))
    factor = np.where(angle < _SMALL, series, closed)
    inverse: Array = np.eye(3) + 0.5 * K + factor * (K @ K)
    return inverse
