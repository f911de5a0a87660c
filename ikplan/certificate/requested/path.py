"""A requested tool path: pieces end to end, and the waypoints on them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ikplan.arrays import Array, Flags, Indices, clamped
from ikplan.certificate.requested.bend_kernels import BendStack, bend_rows
from ikplan.certificate.requested.pieces import BendPiece, CurvePiece, Piece, line
from ikplan.certificate.requested.rounded import RoundedPiece, RoundedPieces

__all__ = ["PathDerivatives", "RequestedPath", "SegmentRange"]


@dataclass(frozen=True, eq=False)
class PathDerivatives:
    """Poses of a path and their derivatives by its length.

    Attributes:
        R: Rotations, shape (m, 3, 3); the identity where the orientation is free.
        p: Positions, shape (m, 3) [m].
        v: dp/ds, shape (m, 3).
        w: Angular rate in the base, shape (m, 3) [rad/m].
    """

    R: Array
    p: Array
    v: Array
    w: Array


@dataclass(frozen=True)
class SegmentRange:
    """The part of a path that one field of the request asks for, rounded corners included.

    Attributes:
        field: The field, such as ``path.segments[3]``.
        begin: Path length at which it begins [m].
        end: Path length at which it ends [m].
        rounded_begin: Whether it begins where the corner before it begins to be rounded.
        rounded_end: Whether it ends where the corner after it ends to be rounded.
    """

    field: str
    begin: float
    end: float
    rounded_begin: bool
    rounded_end: bool


@dataclass(frozen=True, eq=False)
class RequestedPath:
    """Pieces joined end to end.

    Attributes:
        pieces: The pieces, at least one.
        waypoints: Path length [m] and row of each waypoint on the path, in order.
        segments: What of the request each part comes from.
    """

    pieces: tuple[Piece | RoundedPiece, ...]
    waypoints: tuple[tuple[float, int], ...]
    segments: tuple[SegmentRange, ...]

    @cached_property
    def begins(self) -> Array:
        """Path length at which each piece begins, and the whole length, shape (n + 1,) [m]."""
        return np.concatenate([[0.0], np.cumsum([piece.length for piece in self.pieces])])

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.begins[-1])

    @cached_property
    def oriented(self) -> Flags:
        """Whether each piece asks for an orientation, shape (n,)."""
        return np.array([piece.oriented for piece in self.pieces])

    @cached_property
    def spots(self) -> Flags:
        """Whether each piece is a turn on the spot, shape (n,)."""
        return np.array([piece.spot for piece in self.pieces])

    @cached_property
    def _bends(self) -> BendStack:
        """The bend pieces as stacks, rows of others unused."""
        zero, unturned = np.zeros(3), np.eye(3)
        unused = line(zero, zero)
        rows = [piece if isinstance(piece, BendPiece) else unused for piece in self.pieces]
        return BendStack(
            np.array([b.p0 for b in rows]),
            np.array([b.t for b in rows]),
            np.array([b.n for b in rows]),
            np.array([b.c for b in rows]),
            np.array([b.h for b in rows]),
            np.array([b.k for b in rows]),
            np.array([unturned if b.R0 is None else b.R0 for b in rows]),
            np.array([zero if b.R0 is None else b.w for b in rows]),
        )

    @cached_property
    def _curved(self) -> Flags:
        return np.array([not isinstance(piece, BendPiece) for piece in self.pieces])

    @cached_property
    def _rounded(self) -> tuple[RoundedPieces, Indices]:
        """The rounded corners, and the number of each piece among them, -1 for the others."""
        corners = [piece for piece in self.pieces if isinstance(piece, RoundedPiece)]
        among = np.array([isinstance(piece, RoundedPiece) for piece in self.pieces])
        return RoundedPieces(corners), np.where(among, np.cumsum(among) - 1, -1)

    @cached_property
    def nodes(self) -> Array:
        """Path lengths between which the path is smooth and alike, shape (k,) [m]."""
        inner = [
            begin + piece.nodes
            for begin, piece in zip(self.begins, self.pieces, strict=False)
            if not isinstance(piece, BendPiece)
        ]
        return np.sort(np.concatenate([self.begins, *inner]))

    @cached_property
    def curved_and_oriented(self) -> Flags:
        """Whether each piece is a curve without closed arc length that turns the tool, (n,)."""
        return self._curved & self.oriented

    def piece_at(self, s: Array) -> Indices:
        """Return the piece at path lengths s, shape (m,); where two meet, the later one."""
        return clamped(np.searchsorted(self.begins, s, "right") - 1, 0, len(self.pieces) - 1)

    def derivatives(self, piece: Indices, s: Array) -> PathDerivatives:
        """Return poses and derivatives at lengths s from the begins of pieces, both (m,) [m]."""
        curved = self._curved[piece]
        if not curved.any():
            return self._on_bends(piece, s)
        m = len(s)
        out = PathDerivatives(
            np.empty((m, 3, 3)), np.empty((m, 3)), np.empty((m, 3)), np.zeros((m, 3))
        )
        corners, among = self._rounded
        corner = among[piece]
        curve = curved & (corner < 0)
        groups = [np.flatnonzero(piece == k) for k in np.unique(piece[curve])]
        groups += [here for here in map(np.flatnonzero, (~curved, corner >= 0)) if len(here)]
        for here in groups:
            k = piece[here[0]]
            if corner[here[0]] >= 0:
                found = PathDerivatives(*corners.derivatives(corner[here], s[here]))
            elif curve[here[0]]:
                found = self._on_curve(k, s[here])
            else:
                found = self._on_bends(piece[here], s[here])
            out.R[here], out.p[here] = found.R, found.p
            out.v[here], out.w[here] = found.v, found.w
        return out

    def _on_bends(self, piece: Indices, s: Array) -> PathDerivatives:
        m = len(s)
        R, p, v, w = np.empty((m, 3, 3)), np.empty((m, 3)), np.empty((m, 3)), np.empty((m, 3))
        bend_rows(self._bends, piece, np.ascontiguousarray(s), R, p, v, w)
        return PathDerivatives(R, p, v, w)

    def _on_curve(self, k: int, s: Array) -> PathDerivatives:
        piece = self.pieces[k]
        if not isinstance(piece, CurvePiece):
            raise TypeError(f"piece {k} is no curve")
        return PathDerivatives(*piece.derivatives(s))
