"""Pieces along curves without a closed arc length: splines, waves, roses, blends."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.path.curves.arc_length import ArcLength
from ikplan.path.pieces.piece import PathDerivatives, Piece
from ikplan.path.pieces.piece_kernels import CurvedStack, curved_rows, empty_rows, scratch
from ikplan.path.pieces.turning import (
    HeadingTurning,
    SteadyTurning,
    Turning,
    stack_turnings,
)

__all__ = ["CurvedPiece"]


@dataclass(frozen=True)
class CurvedPiece(Piece):
    """A part of a curve, with a law for the orientation or none.

    Attributes:
        curve: The whole curve.
        begin: Arc length of the curve at which the piece begins [m].
        length: Length of the piece [m].
        turning: The law of the orientation; None: free.
    """

    curve: ArcLength
    begin: float
    length: float
    turning: Turning | None = None
    turns: bool = False

    @classmethod
    def whole(cls, curve: ArcLength, turning: Turning | None = None) -> CurvedPiece:
        """Return the piece that is all of a curve."""
        return cls(curve, 0.0, curve.length, turning)

    @property
    def oriented(self) -> bool:  # type: ignore[override]
        """Whether an orientation is asked for."""
        return self.turning is not None

    @property
    def folds(self) -> tuple[float, ...]:  # type: ignore[override]
        """Lengths from the piece's begin at which the curve turns back within a point [m]."""
        inside = (s - self.begin for s in self.curve.folds)
        return tuple(s for s in inside if 0.0 < s < self.length)

    def evaluate(self, s: Array) -> PathDerivatives:
        """Return poses and derivatives; see :meth:`Piece.evaluate`."""
        out = empty_rows(len(s))
        curved_rows(
            self.curve.stack,
            stack_turnings([] if self.turning is None else [self.turning]),
            CurvedStack(np.zeros(1, dtype=np.int64), np.array([self.begin]), self._law),
            np.zeros(len(s), dtype=np.int64),
            np.ascontiguousarray(s, dtype=np.float64),
            out,
            scratch(),
        )
        return PathDerivatives(*out)

    @property
    def _law(self) -> Indices:
        return np.array([-1 if self.turning is None else 0])

    def trimmed(self, begin: float, end: float) -> CurvedPiece:
        """Return a part; see :meth:`Piece.trimmed`."""
        return replace(self, begin=self.begin + begin, length=end - begin)

    def with_turning(self, R0: Array, rate: Array) -> CurvedPiece:
        """Return an oriented copy; see :meth:`Piece.with_turning`."""
        return replace(self, turning=SteadyTurning(self.begin, R0, rate))

    def following(self, R0: Array, axis: Array) -> CurvedPiece:
        """Return an oriented copy; see :meth:`Piece.following`."""
        return replace(self, turning=HeadingTurning(self.curve, self.begin, R0, axis))
