"""The compiled formula of the steady pieces; see :mod:`ikplan.path.pieces.steady`."""

from __future__ import annotations

import math
from typing import NamedTuple

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array
from ikplan.path.rotation.so3_kernels import exp_into

__all__ = ["SteadyStack", "steady_into"]


class SteadyStack(NamedTuple):
    """Steady pieces as flat arrays, one row a piece; the symbols are those of SteadyPiece."""

    p0: Array
    t: Array
    n: Array
    c: Array
    h: Array
    k: Array
    R0: Array
    w: Array


@leaf_kernel
def _sinc(x: float) -> float:
    return math.sin(x) / x if x != 0.0 else 1.0


@leaf_kernel
def steady_into(
    a: SteadyStack, r: int, x: float, turned: bool, d: Array, R: Array, w: Array, turn: Array
) -> None:
    """Write the motion of piece r at length x from its begin.

    Args:
        a: The pieces.
        r: Index of the piece.
        x: Length from its begin [m].
        turned: Whether rotation and angular rate are wanted.
        d: Out: position and its first two derivatives by the length, shape (3, 3).
        R: Out: rotation, shape (3, 3).
        w: Out: angular rate in the base, shape (3,) [rad/m].
        turn: Scratch, shape (3, 3) or more.
    """
    angle = a.k[r] * x
    sine, cosine = math.sin(angle), math.cos(angle)
    # sinc keeps sin(k s) / k and (1 - cos(k s)) / k exact down to k = 0.
    along = x * _sinc(angle)
    across = 0.5 * x * angle * _sinc(0.5 * angle) ** 2
    for j in range(3):
        t, n, c, h = a.t[r, j], a.n[r, j], a.c[r, j], a.h[r]
        d[0, j] = a.p0[r, j] + h * (along * t + across * n) + x * c
        d[1, j] = h * (cosine * t + sine * n) + c
        d[2, j] = h * a.k[r] * (cosine * n - sine * t)
    if not turned:
        return
    exp_into(x * a.w[r, 0], x * a.w[r, 1], x * a.w[r, 2], turn)
    for j in range(3):
        rate = 0.0
        for i in range(3):
            total = 0.0
            for m in range(3):
                total += a.R0[r, j, m] * turn[m, i]
            R[j, i] = total
            rate += total * a.w[r, i]
        w[j] = rate
