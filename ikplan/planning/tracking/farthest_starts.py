"""Which of many starts of a path are worth tracking it from in full."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.planning.tracking.tracked_path import TrackingFailed

__all__ = ["COARSE", "farthest_starts"]

COARSE = 2.0**-6
"""Step, as a share of the path's length, below which coarse tracking halves no further."""
_FARTHEST = 4
"""How many of the starts that end before the path does are kept: those that get farthest."""


def farthest_starts(track: Callable[[Array], object], starts: Array, length: float) -> Indices:
    """Return the starts that lead along a path in coarse steps, and some that nearly do.

    Most starts that fail do so at the end of their branch, which coarse steps show as well as the
    finest: halving down to these takes most of the time of tracking.

    Args:
        track: Tracks from one configuration, shape (dof,), in coarse steps.
        starts: Configurations, shape (c, dof) [rad or m].
        length: Length of the path [m].

    Returns:
        Their indices, in order.

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    reached = np.full(len(starts), length)
    for k, q_start in enumerate(starts):
        try:
            track(q_start)
        except TrackingFailed as failure:
            reached[k] = failure.s
    farthest = np.argsort(-reached, kind="stable")[:_FARTHEST]
    return np.union1d(np.flatnonzero(reached == length), farthest)
