"""Many poses as arrays, whatever form they are given in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Target, no_freedom

__all__ = ["PoseArrays", "pose_arrays"]

_FORMS = (
    "a list of pinocchio.SE3, matrices of shape (n, 4, 4), rows x y z qx qy qz qw of shape (n, 7), "
    "or positions of shape (n, 3)"
)
_FARTHEST = 1e6
"""Largest coordinate of a pose [m]."""


class PoseArrays(NamedTuple):
    """Poses of the tool in the base.

    Attributes:
        R: Rotations, shape (n, 3, 3); (1, 3, 3), the identity, where no orientation counts.
        p: Positions, shape (n, 3) [m].
        oriented: Whether the orientations count.
    """

    R: Array
    p: Array
    oriented: bool

    def target(self, k: int) -> Target:
        """Return pose k as the target of a solver."""
        weight = ORIENTATION_WEIGHT if self.oriented else 0.0
        return Target(
            self.R[k if self.oriented else 0], self.p[k], self.oriented, weight, no_freedom()
        )

    def missed(self, k: int, R: Array, p: Array) -> tuple[float, float]:
        """Return how far the tool is from pose k [m], and by what angle it is turned [rad].

        Args:
            k: Number of the pose.
            R: Rotation of the tool in the base, shape (3, 3).
            p: Its position, shape (3,) [m].
        """
        distance = float(np.linalg.norm(p - self.p[k]))
        if not self.oriented:
            return distance, 0.0
        M = R.T @ self.R[k]
        twice_sine = np.hypot(np.hypot(M[2, 1] - M[1, 2], M[0, 2] - M[2, 0]), M[1, 0] - M[0, 1])
        return distance, float(np.arctan2(twice_sine, np.trace(M) - 1.0))


def pose_arrays(poses: Any) -> PoseArrays:
    """Return poses as arrays.

    Args:
        poses: A list of ``pinocchio.SE3``, homogeneous matrices of shape (n, 4, 4), rows of
            position and unit quaternion (xyzw) of shape (n, 7), or positions of shape (n, 3) [m].

    Raises:
        InvalidRequest: They are none of these, or one is no pose; names its index.
    """
    if isinstance(poses, Sequence) and len(poses) and hasattr(poses[0], "homogeneous"):
        try:
            poses = [pose.homogeneous for pose in poses]
        except AttributeError as error:
            raise _wrong() from error
    try:
        values = np.ascontiguousarray(poses, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise _wrong() from error
    if values.ndim == 3 and values.shape[1:] == (4, 4):
        _check(~(values[:, 3] == [0.0, 0.0, 0.0, 1.0]).all(axis=1))
        R, p, oriented = values[:, :3, :3], values[:, :3, 3], True
    elif values.ndim == 2 and values.shape[1] == 7:
        R, p, oriented = _rotations(values[:, 3:]), values[:, :3], True
    elif (values.ndim == 2 and values.shape[1] == 3) or values.size == 0:
        R, p, oriented = np.eye(3)[None], values.reshape(-1, 3), False
    else:
        raise _wrong()
    with np.errstate(invalid="ignore"):
        _check(~(np.abs(p) <= _FARTHEST).all(axis=1))
    return PoseArrays(_proper(R), np.ascontiguousarray(p), oriented)


def _rotations(quaternions: Array) -> Array:
    """Rotation matrices, shape (n, 3, 3), of quaternions xyzw, shape (n, 4)."""
    norm = np.sqrt(np.einsum("ni,ni->n", quaternions, quaternions))
    with np.errstate(invalid="ignore"):
        _check(~(np.abs(norm - 1.0) <= 1e-3))
    x, y, z, w = (quaternions / norm[:, None]).T
    R = np.empty((len(quaternions), 3, 3))
    R[:, 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    R[:, 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    R[:, 2, 2] = 1.0 - 2.0 * (x * x + y * y)
    R[:, 0, 1], R[:, 1, 0] = 2.0 * (x * y - z * w), 2.0 * (x * y + z * w)
    R[:, 0, 2], R[:, 2, 0] = 2.0 * (x * z + y * w), 2.0 * (x * z - y * w)
    R[:, 1, 2], R[:, 2, 1] = 2.0 * (y * z - x * w), 2.0 * (y * z + x * w)
    return R


def _proper(R: Array) -> Array:
    """The rotations nearest to matrices that are rotations to 1e-3, shape (n, 3, 3)."""
    R = np.ascontiguousarray(R)
    with np.errstate(invalid="ignore"):
        defect = np.abs(R @ R.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
        _check(~(defect <= 1e-3))
        _check(np.linalg.det(R) <= 0.0)
    far = defect > 1e-13
    if far.any():
        # An error of the matrix would count as an error of the solution.
        U, _, Vt = np.linalg.svd(R[far])
        R = R.copy()
        R[far] = U @ Vt
    return R


def _check(wrong: Any) -> None:
    """Refuse poses of which one is marked."""
    if wrong.any():
        raise _wrong(int(np.argmax(wrong)))


def _wrong(index: int | None = None) -> InvalidRequest:
    field = "poses" if index is None else f"poses[{index}]"
    what = _FORMS if index is None else "a finite position with a proper rotation"
    return InvalidRequest(f"{field}: must be {what}", field=field, allowed=what)
