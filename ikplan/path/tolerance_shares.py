"""How the tolerance of a path is shared: what leaves the path, and by how much of it at most.

A path within the tolerance of the one asked for may be laid first, by rounded corners; the joints
then track that one. Their deviations add up: along every way of planning, the shares that act
together are no more than the whole, and the rest is for the timed samples between which nothing is
looked at.
"""

from __future__ import annotations

__all__ = ["MET", "ROUNDING", "TRACKING", "TRACKING_WITHIN", "left_to_tracking"]

ROUNDING = 0.4
"""Of a rounded corner, or a smooth curve past a run of lines, from the sharp path."""
TRACKING = 0.5
"""Of the joint spline from the path that it tracks, where its points are exact."""
TRACKING_WITHIN = 0.95
"""The same, of what is left to tracking, where its points are within the tolerance only."""
MET = 0.85
"""Within how much of what is left to tracking such a point counts as met."""


def left_to_tracking(rounded: bool) -> float:
    """Return the share of the tolerance that points within it may take, and the spline with them.

    Args:
        rounded: Whether the path that is tracked is rounded within the tolerance.
    """
    return 1.0 - ROUNDING if rounded else 1.0
