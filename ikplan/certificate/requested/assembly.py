"""From items to a path: corners are rounded, waypoints and segments get their path lengths."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from ikplan.certificate.requested.corners import PathItem, Rounding, corner_radius, round_corner
from ikplan.certificate.requested.path import RequestedPath, SegmentRange
from ikplan.certificate.requested.pieces import Piece, line
from ikplan.certificate.requested.poses import RequestedPose
from ikplan.certificate.requested.rounded import RoundedPiece

__all__ = ["assembled"]


def assembled(
    begin: RequestedPose, first: Sequence[int], items: Sequence[PathItem], blend: float
) -> tuple[RequestedPath, dict[int, float]]:
    """Join items to a path.

    Args:
        begin: Where the path begins.
        first: Rows of the waypoints at its begin.
        items: The items, end to end.
        blend: Radius of the corners whose item names none [m].

    Returns:
        The path, and by row the radius of each waypoint at a rounded corner [m].
    """
    first, items = _without_points(list(first), items)
    waypoints = [(0.0, row) for row in first]
    if not items:
        spot = line(begin.p, begin.p, begin.R)
        return RequestedPath((spot,), tuple(waypoints), ()), {}
    radii = [corner_radius(a, b, blend) for a, b in pairwise(items)]
    corners = [
        round_corner(a.piece, b.piece, radius) if radius > 0.0 else None
        for (a, b), radius in zip(pairwise(items), radii, strict=True)
    ]
    pieces: list[Piece | RoundedPiece] = []
    segments: list[SegmentRange] = []
    balls: dict[int, float] = {}
    s, before = 0.0, None
    for k, item in enumerate(items):
        after = corners[k] if k < len(corners) else None
        cut = 0.0 if before is None else before.reach
        piece = _between(item.piece, cut, after)
        end = s
        if piece is not None:
            pieces.append(piece)
            end += piece.length
        begins = s if before is None else s - before.piece.length
        for along, row in item.waypoints:
            at_end = along >= item.piece.length
            if at_end and after is not None:
                waypoints.append((end + after.nearest, row))
                balls[row] = radii[k]
            else:
                waypoints.append((end if at_end else s + along - cut, row))
        if after is not None:
            pieces.append(after.piece)
            end += after.piece.length
        if segments and segments[-1].field == item.field:
            last = segments.pop()
            begins, open_begin = last.begin, last.rounded_begin
        else:
            open_begin = before is not None
        segments.append(SegmentRange(item.field, begins, end, open_begin, after is not None))
        s, before = end, after
    return RequestedPath(tuple(pieces), tuple(waypoints), tuple(segments)), balls


def _without_points(
    first: list[int], items: Sequence[PathItem]
) -> tuple[list[int], list[PathItem]]:
    """Drop pieces that are points; their waypoints and corners go to the item before."""
    kept: list[PathItem] = []
    for item in items:
        if item.piece.length > 0.0:
            kept.append(PathItem(item.piece, item.field, item.blend, list(item.waypoints)))
        elif kept:
            end = kept[-1].piece.length
            kept[-1].waypoints += [(end, row) for _, row in item.waypoints]
            kept[-1].blend = kept[-1].blend if item.blend is None else item.blend
        else:
            first += [row for _, row in item.waypoints]
    return first, kept


def _between(piece: Piece, cut: float, after: Rounding | None) -> Piece | None:
    """What the corners at both ends leave of a piece; None: nothing."""
    end = piece.length if after is None else piece.length - after.reach
    if cut == 0.0 and after is None:
        return piece
    return None if end - cut <= 1e-12 * piece.length else piece.part(cut, end)
