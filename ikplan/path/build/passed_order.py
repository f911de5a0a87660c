"""Rows of the waypoints of a path, by its parts, and in the order in which these are passed."""

from __future__ import annotations

from collections.abc import Sequence

from ikplan.documents.curve import CurveSegment
from ikplan.documents.path import PathRequest
from ikplan.documents.segment import SplineSegment

__all__ = ["RowCounter", "first_rows", "passed_rows"]


class RowCounter:
    """Counts rows; every part of a path begins to count at its first one.

    Attributes:
        at: The row that comes next.
    """

    def __init__(self) -> None:
        self.at = 0

    def __call__(self) -> int:
        """Return the row that comes next, and go on to the one after it."""
        self.at += 1
        return self.at - 1


def first_rows(path: PathRequest) -> list[int]:
    """Return the first row of every waypoint or segment of a path, and the number of all rows."""
    if path.waypoints is not None:
        return list(range(len(path.waypoints) + 1))
    rows = [int(path.begin is not None)]
    for segment in path.segments or ():
        if isinstance(segment, SplineSegment):
            count = len(segment.through)
        else:
            count = 2 if isinstance(segment, CurveSegment) else 1
        rows.append(rows[-1] + count)
    return rows


def passed_rows(path: PathRequest, order: Sequence[int]) -> list[int]:
    """Return the rows of a path in the order in which they are passed.

    Args:
        path: The path.
        order: Numbers of its waypoints or segments in that order.
    """
    first = first_rows(path)
    return [*range(first[0]), *(row for k in order for row in range(first[k], first[k + 1]))]
