"""Rotations: exponential and logarithm on SO(3), their Jacobians, quaternions.

Rotation vectors are in radians, quaternions (x, y, z, w). Every function takes stacks of rotations
on leading axes. Formulas: Sola, Deray, Atchuthan, A micro Lie theory for state estimation in
robotics (2018), appendix B.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.path.rotation.so3_kernels import exp_rows, log_rows, matrix_rows, quaternion_rows

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


_SMALL = 1e-2
"""Angle below which power series are more exact than the closed forms [rad]."""


def rotation_of(quaternion_xyzw: Sequence[float] | Array) -> Array:
    """Return the rotation matrix of unit quaternions (x, y, z, w), shape (..., 3, 3)."""
    q = np.ascontiguousarray(quaternion_xyzw, dtype=np.float64)
    return matrix_rows(q.reshape(-1, 4)).reshape(*q.shape[:-1], 3, 3)


def quaternion_of(R: Array) -> Array:
    """Return the unit quaternions (x, y, z, w) of rotation matrices, shape (..., 4), w >= 0."""
    R = np.ascontiguousarray(R, dtype=np.float64)
    return quaternion_rows(R.reshape(-1, 3, 3)).reshape(*R.shape[:-2], 4)


def cross_matrix(v: Array) -> Array:
    """Return [v]x with [v]x u = v x u, shape (..., 3, 3)."""
    v = np.asarray(v, dtype=np.float64)
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    o = np.zeros_like(x)
    rows = [[o, -z, y], [z, o, -x], [-y, x, o]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def exp(rotvec: Array) -> Array:
    """Return the rotation about ``rotvec`` by its length [rad], shape (..., 3, 3)."""
    v = np.ascontiguousarray(rotvec, dtype=np.float64)
    return exp_rows(v.reshape(-1, 3)).reshape(*v.shape[:-1], 3, 3)


def log(R: Array) -> Array:
    """Return the rotation vector of R, shape (..., 3), of length <= pi [rad].

    Exact near 0 and near pi. At exactly pi one of the two answers is given, always the same.
    """
    R = np.ascontiguousarray(R, dtype=np.float64)
    return log_rows(R.reshape(-1, 3, 3)).reshape(*R.shape[:-2], 3)


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
