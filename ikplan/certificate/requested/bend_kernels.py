"""Lines, arcs, helices and turns on the spot, compiled: see BendPiece for the formulas."""

from __future__ import annotations

import math
from typing import NamedTuple

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Indices

__all__ = ["BendStack", "bend_rows"]


class BendStack(NamedTuple):
    """Bend pieces as flat arrays, one row a piece; those of other pieces are unused.

    Attributes:
        p0: First points, shape (n, 3) [m].
        t: Unit directions at them, across the climb, shape (n, 3).
        n: Unit directions to the centres, shape (n, 3).
        c: Climbs, shape (n, 3).
        h: Shares of the length that are across the climb, shape (n,).
        k: Curvatures of the projections by s, shape (n,) [rad/m].
        R0: Rotations at the begins, shape (n, 3, 3).
        w: Angular rates in the frame of the tool, shape (n, 3) [rad/m].
    """

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
def bend_rows(
    a: BendStack, piece: Indices, s: Array, R: Array, p: Array, v: Array, w: Array
) -> None:
    """Write the motion on piece ``piece[i]`` at length ``s[i]`` from its begin to row i.

    Args:
        a: The pieces.
        piece: Index of the piece, shape (m,).
        s: Length from its begin, shape (m,) [m].
        R: Out: rotations, shape (m, 3, 3); the identity where the orientation is free.
        p: Out: positions, shape (m, 3) [m].
        v: Out: dp/ds, shape (m, 3).
        w: Out: angular rates in the base, shape (m, 3) [rad/m].
    """
    for i in range(len(s)):
        r, at = piece[i], s[i]
        half, whole = 0.5 * a.k[r] * at, a.k[r] * at
        chord = a.h[r] * at * _sinc(half)
        ahead, aside = chord * math.cos(half), chord * math.sin(half)
        v_ahead, v_aside = a.h[r] * math.cos(whole), a.h[r] * math.sin(whole)
        for j in range(3):
            p[i, j] = a.p0[r, j] + ahead * a.t[r, j] + aside * a.n[r, j] + at * a.c[r, j]
            v[i, j] = v_ahead * a.t[r, j] + v_aside * a.n[r, j] + a.c[r, j]
        x, y, z = at * a.w[r, 0], at * a.w[r, 1], at * a.w[r, 2]
        angle = math.sqrt(x * x + y * y + z * z)
        sine, half_sinc = _sinc(angle), _sinc(0.5 * angle)
        b = 0.5 * half_sinc * half_sinc
        for j in range(3):
            R0x, R0y, R0z = a.R0[r, j, 0], a.R0[r, j, 1], a.R0[r, j, 2]
            # One row of R0 exp(s w), by Rodrigues' formula.
            R[i, j, 0] = (
                R0x * (1.0 - b * (y * y + z * z))
                + R0y * (b * x * y + sine * z)
                + R0z * (b * x * z - sine * y)
            )
            R[i, j, 1] = (
                R0x * (b * x * y - sine * z)
                + R0y * (1.0 - b * (x * x + z * z))
                + R0z * (b * y * z + sine * x)
            )
            R[i, j, 2] = (
                R0x * (b * x * z + sine * y)
                + R0y * (b * y * z - sine * x)
                + R0z * (1.0 - b * (x * x + y * y))
            )
            w[i, j] = R[i, j, 0] * a.w[r, 0] + R[i, j, 1] * a.w[r, 1] + R[i, j, 2] * a.w[r, 2]
