"""A path of a request with exact corners in the place of blends."""

from __future__ import annotations

from collections.abc import Container
from itertools import pairwise

from ikplan.documents.path import PathRequest
from ikplan.documents.segment import (
    ArcSegment,
    JointSegment,
    LineSegment,
    MoveSegment,
    SplineSegment,
)
from ikplan.path import first_rows

__all__ = ["stopping_at", "stops_allowed", "without_blends"]


def without_blends(path: PathRequest) -> PathRequest | None:
    """Return a path with exact corners in the place of blends; None: it has no blends.

    A corner to a joint motion keeps its blend: within its ball the motion may stop as well.
    """
    segments = path.segments or []
    after = [*segments[1:], None]
    exact = [
        segment.model_copy(update={"blend": 0.0})
        if not isinstance(segment, MoveSegment | JointSegment)
        and not isinstance(following, JointSegment)
        and segment.blend
        else segment
        for segment, following in zip(segments, after, strict=False)
    ]
    if not path.blend and all(a is b for a, b in zip(exact, segments, strict=True)):
        return None
    blend = 0.0 if path.blend else path.blend
    return path.model_copy(update={"segments": exact or None, "blend": blend})


def stops_allowed(path: PathRequest) -> frozenset[int]:
    """Return the rows of the waypoints at whose corners a motion may stop instead.

    They are those at the ends of waypoints and segments whose corners are rounded, within a blend
    or within the tolerance.
    """
    within_tolerance = path.blend is None and path.corners != "exact"
    rounded = within_tolerance or bool(path.blend)
    if path.waypoints is not None:
        lines = rounded and path.interpolation == "line"
        return frozenset(range(len(path.waypoints)) if lines else ())
    segments, rows = path.segments or [], first_rows(path)
    return frozenset(
        rows[k + 1] - 1
        for k, (segment, following) in enumerate(pairwise(segments))
        if isinstance(segment, LineSegment | ArcSegment | SplineSegment)
        and not isinstance(following, JointSegment | MoveSegment)
        and (rounded if segment.blend is None else segment.blend > 0.0)
    )


def stopping_at(path: PathRequest, stops: Container[int], *, start_free: bool) -> PathRequest:
    """Return a path whose corners at waypoints of some rows are exact.

    Corners within the tolerance are exact corners to begin with.

    Args:
        path: The path.
        stops: The rows, among those of :func:`stops_allowed`.
        start_free: Whether the path may begin anywhere.
    """
    rows = first_rows(path)
    if path.waypoints is not None:
        return _lines(path, stops, start_free) if path.blend else path
    segments = [
        segment.model_copy(update={"blend": 0.0})
        if rows[k + 1] - 1 in stops and not isinstance(segment, MoveSegment | JointSegment)
        else segment
        for k, segment in enumerate(path.segments or ())
    ]
    return path.model_copy(update={"segments": segments})


def _lines(path: PathRequest, stops: Container[int], start_free: bool) -> PathRequest:
    """Waypoints as lines, which have corners of their own; the rows stay the same."""
    poses, begin, first = list(path.waypoints or ()), None, 0
    if start_free or path.approach != "path":
        begin, first = poses.pop(0), 1
    lines = [
        LineSegment(type="line", to=pose, blend=0.0 if row in stops else None)
        for row, pose in enumerate(poses, first)
    ]
    update = {"waypoints": None, "segments": lines, "begin": begin, "interpolation": "joint"}
    return path.model_copy(update=update)
