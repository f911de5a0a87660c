"""From segments to a tool path: corners are blended, lengths and waypoints laid out."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import replace
from itertools import dropwhile

import numpy as np

from ikplan.path.build.corners import Junctions, blend_radii
from ikplan.path.build.dense_runs import smooth_runs
from ikplan.path.build.found_corners import FoundCorners
from ikplan.path.build.items import ItemWaypoint, PathItem
from ikplan.path.build.tolerance_corners import (
    CornerTolerance,
    may_round,
    rounded_corners,
)
from ikplan.path.pieces.blend import Blend, blend_corner
from ikplan.path.pieces.piece import Piece, Pose
from ikplan.path.pieces.steady import line
from ikplan.path.tolerance_shares import Rounding
from ikplan.path.tool_path import Corner, PathWaypoint, SegmentRange, ToolPath

__all__ = ["assemble"]


_FEW = 64
"""Of fewer pieces, a motion that stops at all corners is tried too."""


def assemble(
    begin: Pose,
    first: Sequence[ItemWaypoint],
    items: Sequence[PathItem],
    blend: float,
    rounding: CornerTolerance | None = None,
    *,
    joint_after: bool = False,
    stops: Container[int] = (),
    found: FoundCorners | None = None,
) -> ToolPath:
    """Join items to a path.

    Args:
        begin: Pose at which the path begins.
        first: Waypoints at the begin.
        items: The items in order, joined end to end.
        blend: Radius of the corners that have none of their own [m].
        rounding: How much those corners may be rounded instead; None: not at all.
        joint_after: Whether there is a corner at its end, to a joint motion.
        stops: Rows of the waypoints at which corners are exact all the same.
        found: Corners rounded before, in another variant of the path; None: there are none.

    Raises:
        InvalidRequest: A blend does not fit, or there is no corner for it.
    """
    whole = list(dropwhile(_is_empty, items))
    before = items[: len(items) - len(whole)]
    first = [*first, *(waypoint for item in before for waypoint in item.waypoints)]
    waypoints = [PathWaypoint(m.row, m.name, 0.0, m.pose.R, m.pose.p) for m in first]
    segments: list[SegmentRange] = []
    for item in before:
        _extend_segment(segments, item.field, 0.0, 0.0)
    if not whole:
        R = begin.R if first and first[-1].pose.R is not None else None
        spot = line(begin.p, begin.p, R)
        return ToolPath((spot,), tuple(waypoints), (), tuple(segments))
    kept = _without_empty(whole)
    for item in kept[:-1]:
        if any(m.s >= item.piece.length and m.row in stops for m in item.waypoints):
            item.blend = 0.0
    junctions = Junctions.between(kept)
    may = may_round(kept, junctions) if rounding is not None else np.zeros(0, dtype=bool)
    corners = junctions
    noisy = False
    if rounding is not None:
        smooth, noisy = smooth_runs(kept, junctions, rounding)
        if len(smooth) != len(kept) or any(a is not b for a, b in zip(smooth, kept, strict=True)):
            kept, junctions = smooth, Junctions.between(smooth)
    radii = blend_radii(kept, junctions, blend, joint_after=joint_after)
    found = found or FoundCorners()
    blends = _blended([item.piece for item in kept], radii, found)
    if rounding is not None:
        blends = rounded_corners(kept, junctions, blends, rounding, found)
    path = _lay_out(waypoints, segments, kept, blends, junctions)
    if rounding is None or not may.any():
        return path
    others: set[Rounding] = {"smooth"} if noisy else set()
    if (may & corners.sharp).any():
        others.add("slight")
    if len(may) < _FEW and (may & ~corners.sharp).any():
        others.add("none")
    return replace(path, taken=rounding.share, other_roundings=frozenset(others))


def _blended(
    pieces: Sequence[Piece], radii: Sequence[float], found: FoundCorners
) -> list[Blend | None]:
    """Round the corners between pieces within the radii asked for; 0: none is."""
    rows = [k for k, radius in enumerate(radii) if radius > 0.0]
    corners = [(pieces[k], pieces[k + 1], (radii[k],)) for k in rows]

    def blended(new: list[int]) -> list[Blend]:
        return [blend_corner(*corners[k][:2], radii[rows[k]]) for k in new]

    blends: list[Blend | None] = [None] * len(radii)
    for k, blend in zip(rows, found.of(corners, blended), strict=True):
        blends[k] = blend
    return blends


def _is_empty(item: PathItem) -> bool:
    """Whether an item leads nowhere: its poses coincide, and so the builder has joined them."""
    return item.piece.length == 0.0


def _without_empty(items: Sequence[PathItem]) -> list[PathItem]:
    """Drop empty items after the first; their waypoints and blends go to the item before."""
    kept: list[PathItem] = []
    for item in items:
        if not _is_empty(item):
            kept.append(PathItem(item.piece, list(item.waypoints), item.field, item.blend))
            continue
        end = kept[-1].piece.length
        kept[-1].waypoints += [ItemWaypoint(end, m.row, m.name, m.pose) for m in item.waypoints]
        kept[-1].blend = kept[-1].blend if item.blend is None else item.blend
        kept[-1].empty.append(item.field)
    return kept


def _extend_segment(segments: list[SegmentRange], field: str, begin: float, end: float) -> None:
    """Append a segment, or lengthen the last one if it comes from the same field."""
    if segments and segments[-1].field == field:
        last = segments.pop()
        begin, end = last.begin, max(last.end, end)
    segments.append(SegmentRange(field, begin, end))


def _lay_out(
    waypoints: list[PathWaypoint],
    segments: list[SegmentRange],
    items: Sequence[PathItem],
    blends: Sequence[Blend | None],
    junctions: Junctions,
) -> ToolPath:
    pieces: list[Piece] = []
    corners: list[Corner] = []
    s, before = 0.0, None
    for k, item in enumerate(items):
        after = blends[k] if k < len(blends) else None
        piece, cut = _between(item.piece, before, after)
        length = 0.0 if piece is None else piece.length
        for fold in item.piece.folds:
            corners.append(Corner(s + fold - cut, item.field, None, 0.0, 0.0, 0.0, True))
        if piece is not None:
            pieces.append(piece)
        end, row = s + length, None
        at = end if after is None else end + after.nearest
        for m in item.waypoints:
            last = m.s >= item.piece.length
            where = at if last else s + m.s - cut
            exact = m.exact and not (last and after is not None)
            waypoints.append(PathWaypoint(m.row, m.name, where, m.pose.R, m.pose.p, exact))
            row = m.row if last else row
        if after is not None:
            pieces.append(after.piece)
            corners.append(
                Corner(at, item.field, row, after.radius, after.deviation, after.rotation, False)
            )
            end += after.piece.length
        elif k + 1 < len(items) and junctions.jump[k]:
            corners.append(Corner(end, item.field, row, 0.0, 0.0, 0.0, True))
        begin = s if before is None else s - before.piece.length
        _extend_segment(segments, item.field, begin, end)
        for field in item.empty:
            _extend_segment(segments, field, at, at)
        s, before = end, after
    return ToolPath(tuple(pieces), tuple(waypoints), tuple(corners), tuple(segments))


def _between(piece: Piece, before: Blend | None, after: Blend | None) -> tuple[Piece | None, float]:
    """What two blends leave of a piece, and how much is cut off its begin [m]."""
    cut = 0.0 if before is None else before.reach
    end = piece.length if after is None else piece.length - after.reach
    if before is None and after is None:
        return piece, 0.0
    if end - cut <= 1e-12 * piece.length:
        return None, cut
    return piece.trimmed(cut, end), cut
