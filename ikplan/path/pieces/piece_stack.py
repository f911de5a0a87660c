"""All pieces of a path as flat arrays, and their evaluation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.path.curves.arc_length import ArcLength, stack_curves
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.piece import PathDerivatives, Piece
from ikplan.path.pieces.piece_kernels import (
    CurvedStack,
    PieceStack,
    Rows,
    empty_rows,
    piece_rows,
    scratch,
)
from ikplan.path.pieces.steady import SteadyPiece, stack_steady
from ikplan.path.pieces.turning import Turning, stack_turnings

__all__ = ["motion_on", "stack_pieces"]


def stack_pieces(pieces: Sequence[Piece]) -> PieceStack:
    """Return pieces as flat arrays.

    Raises:
        TypeError: A piece of a class that no kernel evaluates.
    """
    steady: list[SteadyPiece] = []
    curved: list[CurvedPiece] = []
    rows = np.empty(len(pieces), dtype=np.int64)
    for k, piece in enumerate(pieces):
        if isinstance(piece, SteadyPiece):
            rows[k] = len(steady)
            steady.append(piece)
        elif isinstance(piece, CurvedPiece):
            rows[k] = -1 - len(curved)
            curved.append(piece)
        else:
            raise TypeError(f"no piece of a path: {type(piece).__name__}")
    # Many pieces may be parts of one curve, and have one law of turning.
    curves: dict[int, tuple[int, ArcLength]] = {}
    laws: dict[int, tuple[int, Turning]] = {}
    for piece in curved:
        curves.setdefault(id(piece.curve), (len(curves), piece.curve))
        if piece.turning is not None:
            laws.setdefault(id(piece.turning), (len(laws), piece.turning))
    stack = CurvedStack(
        np.array([curves[id(piece.curve)][0] for piece in curved], dtype=np.int64),
        np.array([piece.begin for piece in curved], dtype=np.float64),
        np.array(
            [-1 if piece.turning is None else laws[id(piece.turning)][0] for piece in curved],
            dtype=np.int64,
        ),
    )
    return PieceStack(
        stack_steady(steady),
        stack_curves([curve for _, curve in curves.values()]),
        stack_turnings([law for _, law in laws.values()]),
        stack,
        rows,
    )


def motion_on(
    stack: PieceStack, piece: Indices, s: Array, *, turned: bool = True
) -> PathDerivatives:
    """Return the motion at lengths s from the begins of pieces, both of shape (m,).

    Args:
        stack: The pieces.
        piece: Indices of pieces.
        s: Lengths from their begins [m].
        turned: Whether rotations and angular rates are wanted; without, they are left undefined.
    """
    m = len(s)
    if turned:
        out = empty_rows(m)
    else:
        one = empty_rows(1)
        out = Rows(one.R, np.empty((m, 3)), np.empty((m, 3)), one.w, np.empty((m, 3)))
    piece_rows(
        stack,
        np.ascontiguousarray(piece, dtype=np.int64),
        np.ascontiguousarray(s, dtype=np.float64),
        turned,
        out,
        scratch(),
    )
    return PathDerivatives(*out)
