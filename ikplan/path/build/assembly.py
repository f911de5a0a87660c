"""From segments to a tool path: corners are blended, lengths and waypoints laid out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import dropwhile, pairwise

from ikplan.path.build.corners import Joints, blend_radii
from ikplan.path.build.items import Item, Mark
from ikplan.path.pieces.blend import Blend, blend_corner
from ikplan.path.pieces.piece import Piece, Pose
from ikplan.path.pieces.steady import line
from ikplan.path.tool_path import Corner, PathStretch, PathWaypoint, ToolPath

__all__ = ["assemble"]


def assemble(begin: Pose, first: Sequence[Mark], items: Sequence[Item], blend: float) -> ToolPath:
    """Join items to a path.

    Args:
        begin: Pose at which the path begins.
        first: Waypoints at the begin.
        items: The items in order, joined end to end.
        blend: Radius of the corners that have none of their own [m].

    Raises:
        InvalidRequest: A blend does not fit, or there is no corner for it.
    """
    whole = list(dropwhile(_is_empty, items))
    before = items[: len(items) - len(whole)]
    first = [*first, *(mark for item in before for mark in item.marks)]
    waypoints = [PathWaypoint(m.row, m.name, 0.0, m.pose.R, m.pose.p) for m in first]
    stretches: list[PathStretch] = []
    for item in before:
        _stretch_to(stretches, item.field, 0.0, 0.0)
    if not whole:
        R = begin.R if first and first[-1].pose.R is not None else None
        spot = line(begin.p, begin.p, R)
        return ToolPath((spot,), tuple(waypoints), (), tuple(stretches))
    kept = _without_empty(whole)
    joints = Joints.between(kept)
    return _lay_out(waypoints, stretches, kept, blend_radii(kept, joints, blend), joints)


def _is_empty(item: Item) -> bool:
    """Whether an item leads nowhere: its poses coincide, and so the builder has joined them."""
    return item.piece.length == 0.0


def _without_empty(items: Sequence[Item]) -> list[Item]:
    """Drop empty items after the first; their waypoints and blends go to the item before."""
    kept: list[Item] = []
    for item in items:
        if not _is_empty(item):
            kept.append(Item(item.piece, list(item.marks), item.field, item.blend))
            continue
        end = kept[-1].piece.length
        kept[-1].marks += [Mark(end, m.row, m.name, m.pose) for m in item.marks]
        kept[-1].blend = kept[-1].blend if item.blend is None else item.blend
        kept[-1].empty.append(item.field)
    return kept


def _stretch_to(stretches: list[PathStretch], field: str, begin: float, end: float) -> None:
    """Append a stretch, or lengthen the last one if it comes from the same field."""
    if stretches and stretches[-1].field == field:
        last = stretches.pop()
        begin, end = last.begin, max(last.end, end)
    stretches.append(PathStretch(field, begin, end))


def _lay_out(
    waypoints: list[PathWaypoint],
    stretches: list[PathStretch],
    items: Sequence[Item],
    radii: Sequence[float],
    joints: Joints,
) -> ToolPath:
    blends = [
        blend_corner(a.piece, b.piece, radius) if radius > 0.0 else None
        for (a, b), radius in zip(pairwise(items), radii, strict=True)
    ]
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
        for m in item.marks:
            last = m.s >= item.piece.length
            where = at if last else s + m.s - cut
            exact = not (last and after is not None)
            waypoints.append(PathWaypoint(m.row, m.name, where, m.pose.R, m.pose.p, exact))
            row = m.row if last else row
        if after is not None:
            pieces.append(after.piece)
            corners.append(
                Corner(at, item.field, row, radii[k], after.deviation, after.rotation, False)
            )
            end += after.piece.length
        elif k + 1 < len(items) and joints.jump[k]:
            corners.append(Corner(end, item.field, row, 0.0, 0.0, 0.0, True))
        begin = s if before is None else s - before.piece.length
        _stretch_to(stretches, item.field, begin, end)
        for field in item.empty:
            _stretch_to(stretches, field, at, at)
        s, before = end, after
    return ToolPath(tuple(pieces), tuple(waypoints), tuple(corners), tuple(stretches))


def _between(piece: Piece, before: Blend | None, after: Blend | None) -> tuple[Piece | None, float]:
    """What two blends leave of a piece, and how much is cut off its begin [m]."""
    cut = 0.0 if before is None else before.reach
    end = piece.length if after is None else piece.length - after.reach
    if before is None and after is None:
        return piece, 0.0
    if end - cut <= 1e-12 * piece.length:
        return None, cut
    return piece.trimmed(cut, end), cut
