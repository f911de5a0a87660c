"""Rounded corners kept from one variant of a path for the next, which rounds most of them alike."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import blake2b

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.path.pieces.blend import Blend
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.piece import Piece
from ikplan.path.pieces.steady import SteadyPiece

__all__ = ["FoundCorners"]


class FoundCorners:
    """Corners rounded before, by the numbers that their curves follow from.

    The same path is laid with all corners rounded, with some and with none. A corner between
    pieces of the same numbers, within the same bounds, has the same curve.
    """

    def __init__(self) -> None:
        self._found: dict[tuple[bytes, tuple[float, ...]], Blend | None] = {}

    def between(
        self,
        before: Piece,
        after: Piece,
        bounds: tuple[float, ...],
        find: Callable[[], Blend | None],
    ) -> Blend | None:
        """Return a rounded corner; None: there is no room for it.

        Args:
            before: The piece that ends at the corner.
            after: The piece that begins there.
            bounds: What else it follows from: the radius of a blend; or what is allowed.
            find: Rounds it, where it was not rounded before.
        """
        key = _numbers(before) + _numbers(after), bounds
        if key not in self._found:
            self._found[key] = find()
        return self._found[key]


def _numbers(piece: Piece) -> bytes:
    """A digest of all numbers of a piece: of the same digest, the same curve."""
    arrays: tuple[Array | Indices, ...]
    if isinstance(piece, SteadyPiece):
        scalars = [piece.h, piece.k, piece.length, piece.oriented, piece.turns]
        arrays = piece.p0, piece.t, piece.n, piece.c, piece.R0, piece.w
    elif isinstance(piece, CurvedPiece):
        scalars = [piece.begin, piece.length, piece.turning is not None, piece.turns]
        turning = () if piece.turning is None else piece.turning.stack
        arrays = *piece.curve.stack, *turning
    else:
        raise TypeError(f"a piece of another kind: {type(piece).__name__}")
    digest = blake2b(type(piece).__name__.encode(), digest_size=16)
    for array in (np.array(scalars, dtype=np.float64), *arrays):
        digest.update(len(array).to_bytes(8, "little"))
        digest.update(array.tobytes())
    return digest.digest()
