"""The limits of the joints as linear rows in path acceleration and squared path velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel
from ikplan.timing.joint_path import JointPath
from ikplan.timing.limits import JointLimits

__all__ = ["Grid", "StageRows", "joint_rows"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes along a span of a path, every knot of the span among them.

    Attributes:
        s: Path positions of the nodes, shape (n + 1,), strictly increasing.
        pieces: Piece of the path that each interval belongs to, shape (n,).
    """

    s: Array
    pieces: Indices


@dataclass(frozen=True, eq=False)
class StageRows:
    """Constraints a u + b x <= 1 in each interval and x <= x_max at each node.

    u is the second time derivative of s, constant in an interval, and x the square of the first
    at the interval's start; x at the interval's end is x + 2 u h.

    Attributes:
        s: Path positions of the nodes, shape (n + 1,).
        a: Coefficients of u, shape (n, m).
        b: Coefficients of x, shape (n, m).
        x_max: Upper bounds of x at the nodes, shape (n + 1,).
    """

    s: Array
    a: Array
    b: Array
    x_max: Array


@kernel
def _fill(
    h: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    qs1: Array,
    acceleration: Array,
    acceleration_lower: Array,
    velocity: Array,
    velocity_lower: Array,
) -> tuple[Array, Array, Array]:
    n, dof = qs0.shape
    a, b = np.empty((n, 6 * dof)), np.empty((n, 6 * dof))
    x_max = np.full(n + 1, np.inf)
    for i in range(n):
        for j in range(dof):
            c2 = qss1[i, j] - qss0[i, j]
            for side in range(2):
                bound = acceleration[j] if side == 0 else acceleration_lower[j]
                first = 3 * (2 * j + side)
                a[i, first] = qs0[i, j] / bound
                b[i, first] = qss0[i, j] / bound
                a[i, first + 1] = (qs0[i, j] + 1.5 * h[i] * qss0[i, j]) / bound
                b[i, first + 1] = (qss0[i, j] + 0.5 * c2) / bound
                a[i, first + 2] = (qs1[i, j] + 2.0 * h[i] * qss1[i, j]) / bound
                b[i, first + 2] = qss1[i, j] / bound
            for node, qs in ((i, qs0[i, j]), (i + 1, qs1[i, j])):
                if qs != 0.0:
                    root = (velocity[j] if qs > 0.0 else velocity_lower[j]) / qs
                    x_max[node] = min(x_max[node], root * root)
    return a, b, x_max


def joint_rows(path: JointPath, grid: Grid, limits: JointLimits) -> StageRows:
    """Write joint velocity and acceleration limits as rows.

    On an interval of a cubic path with constant path acceleration, a joint's acceleration is a
    quadratic in s. Its three Bezier coefficients are linear in (u, x); bounding them bounds the
    acceleration over the whole interval, and not at its ends alone.

    Args:
        path: The path.
        grid: Nodes of one span of it.
        limits: Joint limits.

    Returns:
        The rows.
    """
    h = np.diff(grid.s)
    _, qs0, qss0 = path.derivatives(grid.s[:-1], grid.pieces)
    _, qs1, qss1 = path.derivatives(grid.s[1:], grid.pieces)
    a, b, x_max = _fill(
        h,
        qs0,
        qss0,
        qss1,
        qs1,
        limits.acceleration,
        limits.acceleration_lower,
        limits.velocity,
        limits.velocity_lower,
    )
    return StageRows(grid.s, a, b, x_max)
