"""The compiled evaluation of pieces at many lengths at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Indices
from ikplan.path.curves.arc_kernels import CurveStack, curve_into
from ikplan.path.pieces.steady_kernels import SteadyStack, steady_into
from ikplan.path.pieces.turning_kernels import WORK, TurnStack, turn_into

__all__ = [
    "CurvedStack",
    "PieceStack",
    "Rows",
    "curved_rows",
    "empty_rows",
    "piece_rows",
    "scratch",
    "steady_rows",
]


class CurvedStack(NamedTuple):
    """Curved pieces as flat arrays, one row a piece.

    Attributes:
        curve: Index of the curve of each, shape (n,).
        begin: Arc length of the curve at which each begins, shape (n,) [m].
        law: Index of the law of turning of each, shape (n,); -1: free.
    """

    curve: Indices
    begin: Array
    law: Indices


class PieceStack(NamedTuple):
    """All pieces of a path as flat arrays.

    Attributes:
        steady: The steady pieces.
        curves: The curves of the others.
        laws: How the tool turns along them.
        curved: The other pieces.
        row: Row of each piece among the steady ones, or -1 - row among the curved, shape (n,).
    """

    steady: SteadyStack
    curves: CurveStack
    laws: TurnStack
    curved: CurvedStack
    row: Indices


class Rows(NamedTuple):
    """Motion by the path length, to be written to, one row a place; see PathDerivatives."""

    R: Array
    p: Array
    v: Array
    w: Array
    bend: Array


LAST = WORK[0]
"""The scratch array has one matrix more than the laws of turning need."""


def empty_rows(m: int) -> Rows:
    """Return rows for m places, to be written to."""
    p, v, w, bend = np.empty((4, m, 3))
    return Rows(np.empty((m, 3, 3)), p, v, w, bend)


def scratch() -> Array:
    """Return a scratch array for the kernels."""
    return np.empty((LAST + 1, *WORK[1:]))


@leaf_kernel
def _curved_into(
    curves: CurveStack,
    laws: TurnStack,
    pieces: CurvedStack,
    r: int,
    s: float,
    turned: bool,
    d: Array,
    R: Array,
    w: Array,
    work: Array,
) -> None:
    """Write the motion of curved piece r at length s from its begin; see steady_into."""
    c, law, along = pieces.curve[r], pieces.law[r], pieces.begin[r] + s
    node, t, speed = curve_into(curves, c, along, d)
    if not turned:
        return
    if law >= 0:
        turn_into(laws, law, along, t, node - curves.first[c], speed, d, R, w, work)
        return
    for i in range(3):
        w[i] = 0.0
        for j in range(3):
            R[i, j] = 1.0 if i == j else 0.0


@leaf_kernel
def curved_rows(
    curves: CurveStack,
    laws: TurnStack,
    pieces: CurvedStack,
    row: Indices,
    s: Array,
    out: Rows,
    work: Array,
) -> None:
    """Write the motion of curved piece ``row[i]`` at length ``s[i]`` from its begin to row i."""
    for i in range(len(s)):
        d = work[LAST]
        _curved_into(curves, laws, pieces, row[i], s[i], True, d, out.R[i], out.w[i], work)
        _put(d, i, out)


@leaf_kernel
def steady_rows(a: SteadyStack, row: Indices, s: Array, out: Rows, work: Array) -> None:
    """Write the motion of steady piece ``row[i]`` at length ``s[i]`` from its begin to row i."""
    for i in range(len(s)):
        steady_into(a, row[i], s[i], True, work[LAST], out.R[i], out.w[i], work[0])
        _put(work[LAST], i, out)


@leaf_kernel
def piece_rows(
    pieces: PieceStack, piece: Indices, s: Array, turned: bool, out: Rows, work: Array
) -> None:
    """Write the motion on piece ``piece[i]`` at length ``s[i]`` from its begin to row i.

    Args:
        pieces: The pieces.
        piece: Index of the piece, shape (m,).
        s: Length from its begin, shape (m,) [m].
        turned: Whether rotations and angular rates are wanted.
        out: Out: the motion.
        work: Scratch, shape (LAST + 1, 4, 4).
    """
    for i in range(len(s)):
        r, d = pieces.row[piece[i]], work[LAST]
        # What is not turned has one row for the rotation and the rate, which nobody reads.
        k = i if turned else 0
        R, w = out.R[k], out.w[k]
        if r >= 0:
            steady_into(pieces.steady, r, s[i], turned, d, R, w, work[0])
        else:
            _curved_into(
                pieces.curves, pieces.laws, pieces.curved, -1 - r, s[i], turned, d, R, w, work
            )
        _put(d, i, out)


@leaf_kernel
def _put(d: Array, i: int, out: Rows) -> None:
    for j in range(3):
        out.p[i, j], out.v[i, j], out.bend[i, j] = d[0, j], d[1, j], d[2, j]
