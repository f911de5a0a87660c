"""What must hold at a tool target, as the kernels see it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Target", "pose_target"]

Array = NDArray[np.float64]


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


def pose_target(position: Array, rotation: Array | None = None, weight: float = 1.0) -> Target:
    """Return the target of a position, shape (3,) [m], and a rotation, shape (3, 3), if any."""
    p = np.ascontiguousarray(position, dtype=np.float64)
    if rotation is None:
        return Target(np.eye(3), p, False, 0.0)
    return Target(np.ascontiguousarray(rotation, dtype=np.float64), p, True, weight)
