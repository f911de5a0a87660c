"""Rounded corners kept from one variant of a path for the next, which rounds most of them alike."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from hashlib import blake2b

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.path.pieces.blend import Blend
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.piece import Piece
from ikplan.path.pieces.steady import SteadyPiece

__all__ = ["FoundCorners"]

SharpCorner = tuple[Piece, Piece, tuple[float, ...]]
"""The piece that ends at a corner, the piece that begins there, and what else the curve follows
from: the radius of a blend; or what is allowed."""


class FoundCorners:
    """Corners rounded before, by the numbers that their curves follow from.

    The same path is laid with all corners rounded, with some and with none. A corner between
    pieces of the same numbers, within the same bounds, has the same curve.
    """

    def __init__(self) -> None:
        self._found: dict[tuple[bytes, tuple[float, ...]], Blend | None] = {}

    def of(
        self,
        corners: Sequence[SharpCorner],
        find: Callable[[list[int]], Sequence[Blend | None]],
    ) -> list[Blend | None]:
        """Return the rounded corners; None: there is no room for one.

        Args:
            corners: The corners.
            find: Rounds those of some indices, which were not rounded before.
        """
        digests: dict[int, bytes] = {}
        for piece in (piece for corner in corners for piece in corner[:2]):
            if id(piece) not in digests:
                digests[id(piece)] = _numbers(piece)
        keys = [(digests[id(a)] + digests[id(b)], bounds) for a, b, bounds in corners]
        new = {key: k for k, key in enumerate(keys) if key not in self._found}
        if new:
            self._found.update(zip(new, find(list(new.values())), strict=True))
        return [self._found[key] for key in keys]


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
