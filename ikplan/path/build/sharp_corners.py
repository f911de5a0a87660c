"""How far rounded corners of a path are from the sharp ones, all of them at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Indices, clamped, length_of, lengths_of
from ikplan.path.pieces.blend import Blend
from ikplan.path.pieces.piece import Piece, dot
from ikplan.path.pieces.piece_kernels import PieceStack
from ikplan.path.pieces.piece_stack import motion_on, stack_pieces
from ikplan.path.rotation.so3 import angle_between

__all__ = ["SharpCorners"]


_PLACES = np.linspace(0.0, 1.0, 17)
"""Where a rounded corner is held to its sharp sides, as shares of its length."""
_STEPS = 3
"""Steps along the tangent to the place of a side that is nearest to a place of the curve."""


@dataclass(frozen=True, eq=False)
class SharpCorners:
    """Corners of a path, one row each.

    Attributes:
        rows: The piece that ends at each corner; the next one begins there, shape (n,).
        pieces: The pieces of the path.
        bends: How far the direction changes at each, shape (n,): the chord of unit vectors.
    """

    rows: Indices
    pieces: tuple[Piece, ...]
    bends: Array
    _stack: PieceStack
    _lengths: Array

    @classmethod
    def of(cls, pieces: Sequence[Piece], wanted: Sequence[bool]) -> SharpCorners:
        """Return some of the corners between the pieces of a path.

        Args:
            pieces: The n pieces, in order.
            wanted: Which of the n - 1 corners.
        """
        rows = np.flatnonzero(wanted)
        stack, lengths = stack_pieces(pieces), np.array([piece.length for piece in pieces])
        before = motion_on(stack, rows, lengths[rows])
        after = motion_on(stack, rows + 1, np.zeros(len(rows)))
        bends = np.array([length_of(v) for v in after.v - before.v])
        return cls(rows, tuple(pieces), bends, stack, lengths)

    def sides(self, k: int) -> tuple[Piece, Piece]:
        """Return the pieces before and after a corner."""
        row = self.rows[k]
        return self.pieces[row], self.pieces[row + 1]

    def ratios_off(
        self,
        corners: Sequence[int],
        blends: Sequence[Blend],
        ratios: Callable[[Array, Array], Array],
    ) -> Array:
        """Return how far rounded corners are from their sharp sides at most.

        Args:
            corners: The corners, n of them.
            blends: Their curves.
            ratios: Gives the ratios to what is allowed of distances and angles.

        Returns:
            Ratios, shape (n,).
        """
        before = self.rows[list(corners)]
        n, m = len(before), len(_PLACES) + 1
        length = np.array([blend.piece.length for blend in blends])
        nearest = np.array([blend.nearest for blend in blends])
        reach = np.array([blend.reach for blend in blends])
        oriented = np.repeat([blend.piece.oriented for blend in blends], m)
        places = np.column_stack([_PLACES * length[:, None], nearest])
        curve = motion_on(
            stack_pieces([blend.piece for blend in blends]),
            np.repeat(np.arange(n), m),
            places.ravel(),
        )
        # Up to the pose nearest to the corner a place is held to the side before it, then to that
        # after it.
        first = places <= nearest[:, None]
        end = self._lengths[before][:, None]
        low = np.where(first, end - reach[:, None], 0.0)
        high = np.where(first, end, reach[:, None])
        s = np.where(first, low + places, (high - length[:, None]) + places)
        side = np.where(first, before[:, None], before[:, None] + 1).ravel()
        low, high = low.ravel(), high.ravel()
        s = clamped(s.ravel(), low, high)
        sharp = motion_on(self._stack, side, s)
        for _ in range(_STEPS):
            s = clamped(s + dot(curve.p - sharp.p, sharp.v), low, high)
            sharp = motion_on(self._stack, side, s)
        off = _ratios(ratios, curve.p - sharp.p, curve.R, sharp.R, oriented).reshape(n, m)
        # The pose nearest to the corner is held to the corner itself: a waypoint may be there.
        corner = motion_on(self._stack, before, self._lengths[before])
        at = slice(m - 1, None, m)
        missed = _ratios(ratios, curve.p[at] - corner.p, curve.R[at], corner.R, oriented[at])
        return np.asarray(np.maximum(off.max(axis=1), missed))


def _ratios(
    ratios: Callable[[Array, Array], Array], step: Array, R: Array, sharp: Array, oriented: Array
) -> Array:
    """Ratios to what is allowed of steps and, where it counts, of the angles between rotations."""
    angle = np.zeros(len(step))
    angle[oriented] = angle_between(R[oriented], sharp[oriented])
    return ratios(lengths_of(step), angle)
