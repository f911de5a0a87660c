"""What must hold at a tool target, as the kernels see it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel

__all__ = ["ORIENTATION_WEIGHT", "Target", "pose_defect", "pose_target"]

Array = NDArray[np.float64]

ORIENTATION_WEIGHT = 0.3
"""What one radian weighs against one metre while a solution is looked for: about the lever of a
wrist; measured to take the fewest steps over the catalogue's arms [m/rad]."""


class Target(NamedTuple):
    """A tool pose wanted, with the rows of the pose error that count.

    Attributes:
        R: Rotation of the tool in the base, shape (3, 3); identity for a position target.
        p: Position of the tool in the base, shape (3,) [m].
        oriented: Whether the orientation counts.
        weight: What one radian of rotation weighs against one metre of distance [m/rad].
    """

    R: Array
    p: Array
    oriented: bool
    weight: float


@kernel
def pose_defect(R: Array, p: Array) -> float:
    """How far R, shape (3, 3), is from a rotation; inf where it or p, shape (3,), is no pose.

    Returns:
        Largest entry of |R R^T - I|, or inf: not finite, a reflection, or farther than 1e6 m away.
    """
    defect = 0.0
    for i in range(3):
        if not abs(p[i]) <= 1e6:
            return np.inf
        for j in range(i + 1):
            dot = R[i, 0] * R[j, 0] + R[i, 1] * R[j, 1] + R[i, 2] * R[j, 2]
            off = abs(dot - (1.0 if i == j else 0.0))
            if not off < np.inf:
                return np.inf
            defect = max(defect, off)
    determinant = (
        R[0, 0] * (R[1, 1] * R[2, 2] - R[1, 2] * R[2, 1])
        - R[0, 1] * (R[1, 0] * R[2, 2] - R[1, 2] * R[2, 0])
        + R[0, 2] * (R[1, 0] * R[2, 1] - R[1, 1] * R[2, 0])
    )
    return defect if determinant > 0.0 else np.inf


def pose_target(
    position: Array, rotation: Array | None = None, weight: float = ORIENTATION_WEIGHT
) -> Target:
    """Return the target of a position, shape (3,) [m], and a rotation, shape (3, 3), if any."""
    p = np.ascontiguousarray(position, dtype=np.float64)
    if rotation is None:
        return Target(np.eye(3), p, False, 0.0)
    return Target(np.ascontiguousarray(rotation, dtype=np.float64), p, True, weight)
