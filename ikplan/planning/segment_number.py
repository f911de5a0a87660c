"""The number of a segment of a request, from the field that names it."""

from __future__ import annotations

import re

from ikplan.path import JointWaypoint

__all__ = ["segment_number", "segment_to"]

_SEGMENT = re.compile(r"path\.(?:segments|waypoints)\[(\d+)\]")


def segment_to(waypoint: JointWaypoint) -> int | None:
    """Return the number of the segment that ends at a waypoint; None: none of the path does."""
    return segment_number(waypoint.field or waypoint.name)


def segment_number(field: str) -> int | None:
    """Return k of ``path.segments[k]`` or ``path.waypoints[k]``; None for any other field.

    Segment k of waypoints is the one that ends at waypoint k.
    """
    found = _SEGMENT.match(field)
    return None if found is None else int(found[1])
