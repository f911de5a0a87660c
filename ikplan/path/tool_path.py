"""A continuous tool path in the robot's base."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.path.pieces.piece import PathDerivatives, Piece
from ikplan.path.pieces.piece_kernels import PieceStack
from ikplan.path.pieces.piece_stack import motion_on, stack_pieces
from ikplan.path.tolerance_shares import Rounding

__all__ = ["Corner", "PathWaypoint", "SegmentRange", "ToolPath"]


@dataclass(frozen=True)
class PathWaypoint:
    """A pose asked for, on a tool path.

    Attributes:
        row: Its row among the waypoints of the request.
        name: Where the request asks for it, such as ``path.waypoints[3]``.
        s: Path length at which it is passed, or passed nearest [m].
        R: Rotation asked for in the base, shape (3, 3); None: free.
        p: Position asked for in the base, shape (3,) [m].
        exact: Whether the path passes it; false at a blended corner.
    """

    row: int
    name: str
    s: float
    R: Array | None
    p: Array
    exact: bool = True


@dataclass(frozen=True)
class Corner:
    """A place where the path changes its direction or its angular rate.

    Attributes:
        s: Path length of it; of a blended corner, where the path is nearest to it [m].
        name: What of the request ends there.
        waypoint: Row of the waypoint there; None: none.
        blend: Radius within which it is rounded [m]; 0: exact.
        deviation: Distance of the path from the corner [m].
        rotation: Rotation of the path, where it is nearest, from the corner's [rad].
        stops: Whether the motion must stop there.
    """

    s: float
    name: str
    waypoint: int | None
    blend: float
    deviation: float
    rotation: float
    stops: bool


@dataclass(frozen=True)
class SegmentRange:
    """The part of a path that comes from one field of the request, rounded corners included.

    Attributes:
        field: The field, such as ``path.segments[3]``.
        begin: Path length at which it begins [m].
        end: Path length at which it ends [m].
    """

    field: str
    begin: float
    end: float


@dataclass(frozen=True)
class ToolPath:
    """Pieces joined end to end, parametrised by path length s from 0 to ``length``.

    s is the arc length of the tool's position in metres; a turn on the spot counts TURN_LENGTH
    for each radian.

    Attributes:
        pieces: The pieces in order, at least one; of length 0 only if it is the only one.
        waypoints: The poses asked for that are on this path, in order.
        corner_list: Every corner, rounded or exact, in order.
        segments: What of the request each part comes from, in order; rounded corners belong to
            both their neighbours.
        taken: Share of the tolerance that rounded corners take; 0: none may be rounded.
        other_roundings: Other ways to round corners that may be faster.
    """

    pieces: tuple[Piece, ...]
    waypoints: tuple[PathWaypoint, ...] = ()
    corner_list: tuple[Corner, ...] = ()
    segments: tuple[SegmentRange, ...] = ()
    taken: float = 0.0
    other_roundings: frozenset[Rounding] = frozenset()

    @cached_property
    def begins(self) -> Array:
        """Path length at which each piece begins, and the whole length, shape (n + 1,) [m]."""
        return np.concatenate([[0.0], np.cumsum([piece.length for piece in self.pieces])])

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.begins[-1])

    @cached_property
    def corners(self) -> Array:
        """Path lengths at which the motion must stop, without the ends, shape (k,) [m]."""
        return np.array([c.s for c in self.corner_list if c.stops and 0.0 < c.s < self.length])

    @cached_property
    def waypoint_s(self) -> Array:
        """Path length of each waypoint, shape (n,) [m]."""
        return np.array([waypoint.s for waypoint in self.waypoints])

    @cached_property
    def orientation_changes(self) -> Array:
        """Path lengths at which an orientation begins or ends to be asked for, shape (k,) [m]."""
        return np.asarray(self.begins[1:-1][self._oriented[1:] != self._oriented[:-1]])

    @cached_property
    def _oriented(self) -> Flags:
        return np.array([piece.oriented for piece in self.pieces])

    @cached_property
    def _all_alike(self) -> bool:
        """Whether an orientation is asked for on all pieces, or on none."""
        return bool(self._oriented.all() or not self._oriented.any())

    @cached_property
    def _stack(self) -> PieceStack:
        return stack_pieces(self.pieces)

    def pose(self, s: float) -> tuple[Array, Array]:
        """Return rotation (3, 3) and position (3,) [m] of the tool at path length s.

        The rotation is the identity where the orientation is free.
        """
        R, p = self.poses(np.array([s]))
        return R[0], p[0]

    def poses(self, s: Array) -> tuple[Array, Array]:
        """Return rotations (m, 3, 3) and positions (m, 3) [m] at path lengths s, shape (m,)."""
        derivatives = self.derivatives(s)
        return derivatives.R, derivatives.p

    def derivatives(self, s: Array) -> PathDerivatives:
        """Return poses and their derivatives by s at path lengths s, shape (m,) [m].

        At a corner the derivatives are those after it.
        """
        s = np.asarray(s, dtype=np.float64)
        piece = self.piece_at(s)
        return self.derivatives_on(piece, s - self.begins[piece])

    def piece_at(self, s: Array) -> Indices:
        """Return the index of the piece at path lengths s, shape (m,).

        At a joint: the piece after it, unless only the one before asks for an orientation.
        """
        after = np.searchsorted(self.begins, s, "right")
        piece = np.minimum(np.maximum(after - 1, 0), len(self.pieces) - 1)
        if self._all_alike:
            return piece
        before = np.maximum(piece - 1, 0)
        back = (s == self.begins[piece]) & ~self._oriented[piece] & self._oriented[before]
        return np.where(back, before, piece)

    def positions(self, s: Array) -> Array:
        """Return positions at path lengths s, shape (m,) [m] -> (m, 3) [m]."""
        s = np.asarray(s, dtype=np.float64)
        piece = self.piece_at(s)
        return motion_on(self._stack, piece, s - self.begins[piece], turned=False).p

    def derivatives_on(self, piece: Indices, s: Array) -> PathDerivatives:
        """Return the motion at lengths s from the begins of pieces, both of shape (m,)."""
        return motion_on(self._stack, piece, s)

    def oriented(self, s: float) -> bool:
        """Whether an orientation is asked for at path length s; yes at the ends of such spans."""
        return bool(self.orientation_mask(np.array([s]))[0])

    def orientation_mask(self, s: Array) -> Flags:
        """Return :meth:`oriented` at path lengths s, shape (m,)."""
        if self._all_alike:
            return np.full(len(s), self._oriented[0])
        return self._oriented[self.piece_at(np.asarray(s, dtype=np.float64))]
