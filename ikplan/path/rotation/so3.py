"""Rotations: exponential and logarithm on SO(3), quaternions.

Rotation vectors are in radians, quaternions (x, y, z, w). Every function takes stacks of rotations
on leading axes. Formulas: Sola, Deray, Atchuthan, A micro Lie theory for state estimation in
robotics (2018), appendix B.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.path.rotation.so3_kernels import exp_rows, log_rows, matrix_rows, quaternion_rows

__all__ = ["angle_between", "exp", "log", "quaternion_of", "rotation_of"]


def rotation_of(quaternion_xyzw: Sequence[float] | Array) -> Array:
    """Return the rotation matrix of unit quaternions (x, y, z, w), shape (..., 3, 3)."""
    q = np.ascontiguousarray(quaternion_xyzw, dtype=np.float64)
    return matrix_rows(q.reshape(-1, 4)).reshape(*q.shape[:-1], 3, 3)


def quaternion_of(R: Array) -> Array:
    """Return the unit quaternions (x, y, z, w) of rotation matrices, shape (..., 4), w >= 0."""
    R = np.ascontiguousarray(R, dtype=np.float64)
    return quaternion_rows(R.reshape(-1, 3, 3)).reshape(*R.shape[:-2], 4)


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
