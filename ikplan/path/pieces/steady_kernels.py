"""The compiled formula of the steady pieces; see :mod:`ikplan.path.pieces.steady`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.path.rotation.so3_kernels import exp_into

__all__ = ["SteadyStack", "steady_rows"]


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


@kernel
def _sinc(x: float) -> float:
    return math.sin(x) / x if x != 0.0 else 1.0


@kernel
def steady_rows(
    a: SteadyStack, row: Indices, s: Array, R: Array, p: Array, v: Array, w: Array, bend: Array
) -> None:
    """Write the motion of piece ``row[i]`` at length ``s[i]`` from its begin to row i."""
    turn = np.empty((3, 3))
    for i in range(len(s)):
        r, x = row[i], s[i]
        angle = a.k[r] * x
        sine, cosine = math.sin(angle), math.cos(angle)
        # sinc keeps sin(k s) / k and (1 - cos(k s)) / k exact down to k = 0.
        along = x * _sinc(angle)
        across = 0.5 * x * angle * _sinc(0.5 * angle) ** 2
        for j in range(3):
            t, n, c, h = a.t[r, j], a.n[r, j], a.c[r, j], a.h[r]
            p[i, j] = a.p0[r, j] + h * (along * t + across * n) + x * c
            v[i, j] = h * (cosine * t + sine * n) + c
            bend[i, j] = h * a.k[r] * (cosine * n - sine * t)
        exp_into(x * a.w[r, 0], x * a.w[r, 1], x * a.w[r, 2], turn)
        for j in range(3):
            rate = 0.0
            for h in range(3):
                total = 0.0
                for m in range(3):
                    total += a.R0[r, j, m] * turn[m, h]
                R[i, j, h] = total
                rate += total * a.w[r, h]
            w[i, j] = rate
