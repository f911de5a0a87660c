"""Whether the order in which the parts of a path are passed is one that the request allows."""

from __future__ import annotations

from collections.abc import Sequence

from ikplan.documents.path import PathRequest
from ikplan.documents.segment import JointSegment, MoveSegment

__all__ = ["broken_order"]


def broken_order(path: PathRequest, order: Sequence[int]) -> list[str]:
    """Return what is wrong with the order in which a path is passed, in words.

    Every part is passed once. A tool path follows the segment before it; the last parts that are
    to stay last do. What is carried is not asked about here: the proof that bodies stay apart
    knows when they are there.

    Args:
        path: The path of the request.
        order: Numbers of its waypoints or segments in the order passed.
    """
    parts = path.waypoints or path.segments or ()
    count = len(parts)
    if sorted(order) != list(range(count)):
        return [f"of {count} parts these are passed: {list(order)}"]
    if path.order == "given":
        return [] if list(order) == list(range(count)) else ["the order is not the given one"]
    wrong = []
    segments = path.segments or ()
    for position, k in enumerate(order):
        own = path.waypoints is not None or isinstance(segments[k], MoveSegment | JointSegment)
        before = order[position - 1] if position else -1
        if not own and before != k - 1:
            wrong.append(f"segment {k} does not follow the one before it")
    last = range(count - path.stay_last, count)
    if path.stay_last and list(order[-path.stay_last :]) != list(last):
        wrong.append(f"the last {path.stay_last} parts do not stay last")
    return wrong
