"""What must hold at a tool target, as the kernels see it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = [
    "ORIENTATION_WEIGHT",
    "Freedom",
    "Target",
    "constraint_rows",
    "fixed_rows",
    "no_freedom",
    "pose_defect",
    "pose_target",
]


ORIENTATION_WEIGHT = 0.3
"""What one radian weighs against one metre while a solution is looked for: about the lever of a
wrist; measured to take the fewest steps over the catalogue's arms [m/rad]."""


class Freedom(NamedTuple):
    """What need not hold at a target.

    Attributes:
        axis: Tool axis (0 x, 1 y, 2 z) about which the tool may turn; -1: none.
        cone: How far that axis may lean [rad].
        boxed: Whether the pose may be anywhere within a box around the target.
        box: Half widths of the box, shape (6,): position [m], then rotation vector [rad].
        in_tool: Whether the box is along the target's own axes; otherwise along ``R_box``.
        R_box: Axes of the box in the base, shape (3, 3).
    """

    axis: int
    cone: float
    boxed: bool
    box: Array
    in_tool: bool
    R_box: Array


class Target(NamedTuple):
    """A tool pose wanted, with the rows of the pose error that count.

    Attributes:
        R: Rotation of the tool in the base, shape (3, 3); identity for a position target.
        p: Position of the tool in the base, shape (3,) [m].
        oriented: Whether the orientation counts.
        weight: What one radian of rotation weighs against one metre of distance [m/rad].
        freedom: What need not hold.
    """

    R: Array
    p: Array
    oriented: bool
    weight: float
    freedom: Freedom


def no_freedom() -> Freedom:
    """Return the freedom of a target that must be met exactly."""
    return Freedom(-1, 0.0, False, np.zeros(6), True, np.eye(3))


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
    position: Array,
    rotation: Array | None = None,
    weight: float = ORIENTATION_WEIGHT,
    freedom: Freedom | None = None,
) -> Target:
    """Return the target of a position, shape (3,) [m], and a rotation, shape (3, 3), if any."""
    p = np.ascontiguousarray(position, dtype=np.float64)
    freedom = freedom or no_freedom()
    if rotation is None:
        return Target(np.eye(3), p, False, 0.0, freedom)
    return Target(np.ascontiguousarray(rotation, dtype=np.float64), p, True, weight, freedom)


@kernel
def fixed_rows(freedom: Freedom, oriented: bool) -> int:
    """Return how many of the tool's six degrees of freedom any target of a freedom fixes.

    Args:
        freedom: What need not hold.
        oriented: Whether its orientation counts.
    """
    if freedom.boxed:
        rows = 0
        for i in range(6 if oriented and freedom.axis < 0 else 3):
            if freedom.box[i] == 0.0:
                rows += 1
    else:
        rows = 3
        if oriented and freedom.axis < 0:
            rows = 6
    if oriented and freedom.axis >= 0 and freedom.cone == 0.0:
        rows += 2
    return rows


@kernel
def constraint_rows(target: Target) -> int:
    """Return how many of the tool's six degrees of freedom a target fixes everywhere."""
    return fixed_rows(target.freedom, target.oriented)
