"""The number of a segment of a request, from the field that names it."""

from __future__ import annotations

import re

__all__ = ["segment_number"]


def segment_number(field: str) -> int | None:
    """Return k of ``path.segments[k]`` or ``path.waypoints[k]``; None for any other field.

    Segment k of waypoints is the one that ends at waypoint k.
    """
    found = re.match(r"path\.(?:segments|waypoints)\[(\d+)\]", field)
    return None if found is None else int(found[1])
