"""Corners of a requested path: where they are, and how they are rounded.

A corner is where the direction, or the angular rate, jumps. Rounded within a radius: at most that
much of either side is replaced by the quintic that has the position, direction and curvature of
both sides where it meets them, run through at twice the replaced length a unit of its parameter;
as much as keeps its control points within the ball about the corner, found by steps of a fifth.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, lengths_of
from ikplan.certificate.requested.curves import QuinticCurve
from ikplan.certificate.requested.pieces import TURN_LENGTH, End, Piece
from ikplan.certificate.requested.rounded import QuinticArc, RoundedPiece
from ikplan.certificate.requested.turning import BlendTurn

__all__ = ["PathItem", "Rounding", "corner_radius", "round_corner"]


_JUMP = 1e-6
"""A change of direction, or of angular rate times TURN_LENGTH, by more than this is a corner."""
_BACK = 1e-3
"""Directions this near to opposite turn back [rad]."""


@dataclass(eq=False)
class PathItem:
    """A piece with what the request says of it.

    Attributes:
        piece: The piece.
        field: The field of the request that it comes from.
        blend: Radius of the corner at its end [m]; None: that of the path.
        waypoints: Length on the piece [m] and row of each waypoint on it.
    """

    piece: Piece
    field: str
    blend: float | None = None
    waypoints: list[tuple[float, int]] = dataclasses.field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Rounding:
    """A rounded corner.

    Attributes:
        piece: The curve.
        reach: How much of either side it replaces [m].
        nearest: Length on the curve at which it is nearest to the corner [m].
    """

    piece: RoundedPiece
    reach: float
    nearest: float


def corner_radius(before: PathItem, after: PathItem, default: float) -> float:
    """Return the radius within which the corner between two items is rounded [m]; 0: not at all.

    Args:
        before: The item that ends there.
        after: The item that begins there.
        default: Radius of the path [m]; for corners only, and none where the path turns back or
            the tool turns on the spot.
    """
    if before.blend is not None:
        return before.blend
    if default == 0.0 or before.piece.spot or after.piece.spot:
        return 0.0
    a, b = before.piece.end(before.piece.length), after.piece.end(0.0)
    if np.arctan2(np.linalg.norm(np.cross(a.v, b.v)), a.v @ b.v) > np.pi - _BACK:
        return 0.0
    turn = 0.0
    if a.R is not None and b.R is not None:
        turn = TURN_LENGTH * float(np.linalg.norm(a.w - b.w))
    jumps = float(np.linalg.norm(a.v - b.v)) > _JUMP or turn > _JUMP
    return default if jumps else 0.0


def round_corner(before: Piece, after: Piece, radius: float) -> Rounding:
    """Round the corner between two pieces within a ball of a radius [m] about it."""
    corner, reach = after.end(0.0).p, radius
    for _ in range(40):
        a, b = before.end(before.length - reach), after.end(reach)
        curve = QuinticCurve(_scaled(a, 2.0 * reach), _scaled(b, 2.0 * reach))
        away = lengths_of(curve.control_points - corner)
        if (away <= radius * (1.0 + 1e-9)).all():
            break
        reach *= 0.8
    arc, turn = QuinticArc(curve), None
    if a.R is not None and b.R is not None:
        rates = [2.0 * reach * (end.R.T @ end.w) for end in (a, b) if end.R is not None]
        turn = BlendTurn(a.R, rates[0], b.R, rates[1])
    return Rounding(RoundedPiece(arc, turn), reach, arc.nearest(corner))


def _scaled(end: End, scale: float) -> Array:
    """Position and derivatives by a parameter of which one unit is ``scale`` metres."""
    return np.array([end.p, scale * end.v, scale * scale * end.bend])
