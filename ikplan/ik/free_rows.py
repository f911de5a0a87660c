"""The error of a target that leaves something free, and the rows of the Jacobian it constrains."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array
from ikplan.ik.workspace import Workspace
from ikplan.kinematics.target import Target

__all__ = ["box_error", "free_rows", "lean_error"]


@leaf_kernel
def lean_error(target: Target, e: Array, w: Workspace) -> float:
    """Write the rotation that brings the free axis into its cone to ``e[3:]``.

    Only where the axis points counts: the rotation is the smallest that aligns it, less the cone,
    and has no part about the axis itself.

    Args:
        target: A target with a free axis.
        e: Error in the tool frame, shape (6,).
        w: Buffers, with the tool's pose.

    Returns:
        The angle left outside the cone [rad].
    """
    axis, cone = target.freedom.axis, target.freedom.cone
    R, R_target = w.R, target.R
    # The wanted axis, seen from the tool.
    for i in range(3):
        w.turn[i] = (
            R[0, i] * R_target[0, axis] + R[1, i] * R_target[1, axis] + R[2, i] * R_target[2, axis]
        )
    after, later = (axis + 1) % 3, (axis + 2) % 3
    # e_axis x wanted has -wanted[later] along `after` and wanted[after] along `later`.
    sine = math.hypot(w.turn[after], w.turn[later])
    angle = math.atan2(sine, w.turn[axis])
    left = max(angle - cone, 0.0)
    if sine > 1e-12:
        x, y = -w.turn[later] / sine, w.turn[after] / sine
    else:
        x, y = 1.0, 0.0  # turned right over: any way back is as short
    e[3 + axis] = 0.0
    e[3 + after] = left * x
    e[3 + later] = left * y
    w.counts[3 + axis] = False
    w.counts[3 + after] = left > 0.0 or cone == 0.0
    w.counts[3 + later] = w.counts[3 + after]
    return left


@kernel
def _axes(target: Target, w: Workspace, T: Array) -> None:
    """Write the rotation from the tool's axes to the box's, shape (3, 3)."""
    B = target.R if target.freedom.in_tool else target.freedom.R_box
    for i in range(3):
        for k in range(3):
            T[i, k] = B[0, i] * w.R[0, k] + B[1, i] * w.R[1, k] + B[2, i] * w.R[2, k]


@kernel
def box_error(target: Target, angle: float, e: Array, w: Workspace) -> tuple[float, float]:
    """Take what a box allows off the error, and turn the error to the box's axes.

    Args:
        target: A target with a box.
        angle: Rotation angle of the error [rad], kept where a free axis gave it.
        e: Error in the tool frame, shape (6,); out: the excess along the box's axes.
        w: Buffers, with the tool's pose.

    Returns:
        Distance [m] and angle [rad] left outside the box.
    """
    box = target.freedom.box
    T = np.empty((3, 3))
    _axes(target, w, T)
    rotations = target.freedom.axis < 0
    w.turned[0] = rotations
    total = [0.0, 0.0]
    for part in range(2 if rotations else 1):
        x, y, z = e[3 * part], e[3 * part + 1], e[3 * part + 2]
        for i in range(3):
            row = 3 * part + i
            value = T[i, 0] * x + T[i, 1] * y + T[i, 2] * z
            excess = max(abs(value) - box[row], 0.0)
            e[row] = math.copysign(excess, value)
            w.counts[row] = excess > 0.0 or box[row] == 0.0
            total[part] += excess * excess
    if rotations:
        angle = math.sqrt(total[1])
    return math.sqrt(total[0]), angle


@kernel
def free_rows(target: Target, w: Workspace) -> None:
    """Turn the Jacobian's rows as the error's, and leave out those that do not count."""
    Jt, counts = w.Jt, w.counts
    if target.freedom.boxed:
        T = np.empty((3, 3))
        _axes(target, w, T)
        for j in range(Jt.shape[0]):
            for part in range(2 if w.turned[0] else 1):
                x, y, z = Jt[j, 3 * part], Jt[j, 3 * part + 1], Jt[j, 3 * part + 2]
                for i in range(3):
                    Jt[j, 3 * part + i] = T[i, 0] * x + T[i, 1] * y + T[i, 2] * z
    for j in range(Jt.shape[0]):
        for i in range(6):
            if not counts[i]:
                Jt[j, i] = 0.0
