"""How the tolerance of a path is shared: what leaves the path, and by how much of it at most.

A path within the tolerance of the one asked for may be laid first, by rounded corners; the joints
then track that one. Their deviations add up: along every way of planning, the shares that act
together are no more than the whole, and the rest is for the timed samples between which nothing is
looked at.
"""

from __future__ import annotations

from typing import Literal

__all__ = [
    "MET",
    "ROUNDING",
    "SMOOTHING",
    "TRACKING",
    "TRACKING_SMOOTHED",
    "TRACKING_WITHIN",
    "Rounding",
    "exact_tracking",
    "left_to_tracking",
]

Rounding = Literal["all", "smooth", "slight", "none"]
"""Which corners are rounded within the tolerance; "smooth": all, within a larger share of it."""

ROUNDING = 0.4
"""Of a rounded corner, or a smooth curve past a run of lines, from the sharp path."""
SMOOTHING = 0.8
"""The same, where noise of the points takes more than that to be passed smoothly."""
TRACKING = 0.5
"""Of the joint spline from the path that it tracks, where its points are exact."""
TRACKING_SMOOTHED = 0.15
"""The same beside a path that takes the share of smoothing."""
TRACKING_WITHIN = 0.95
"""The same, of what is left to tracking, where its points are within the tolerance only."""
MET = 0.85
"""Within how much of what is left to tracking such a point counts as met."""


def exact_tracking(rounding: Rounding) -> float:
    """Return the share of the tolerance that the joint spline through exact points may take."""
    return TRACKING_SMOOTHED if rounding == "smooth" else TRACKING


def left_to_tracking(taken: float) -> float:
    """Return the share of the tolerance that points within it may take, and the spline with them.

    Args:
        taken: Share that the path that is tracked takes.
    """
    return 1.0 - taken
