"""Tracking a path within the tolerance, where it cannot be tracked exactly."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.track_from import TrackedPart, first_points, track_from
from ikplan.planning.tracking.tracked_arm import TrackedArm
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.within.tolerance_window import bridge, near_singular

__all__ = ["SpanList", "track_within"]

SpanList = list[tuple[float, float]]
"""Begins and ends of parts of a path, as path positions."""

_MOST_WINDOWS = 12


def track_within(
    tracked: TrackedArm,
    reference: ReferencePath,
    q_start: Array,
    step: float,
    known: TrackedPart | None = None,
) -> tuple[Array, Array, SpanList]:
    """Track a path from one configuration, exactly where that can be, else within the tolerance.

    Args:
        tracked: The arm, and what it has to keep, within the tolerance.
        reference: The path.
        q_start: The configuration at the begin, shape (dof,) [rad or m].
        step: Spacing of the first points [m].
        known: The path from its begin up to a singularity that is to be led over; None: nothing
            is known.

    Returns:
        Path positions, configurations, and the parts that are led over a singularity.

    Raises:
        TrackingFailed: The path cannot be tracked to its end.
        BudgetExceeded: The time budget ran out.
    """
    s, q = np.zeros(1), q_start[None]
    spans: SpanList = []
    while True:
        if known is None:
            points = first_points(tracked, reference, step, float(s[-1]))
            part = track_from(tracked, reference, q[-1], points)
        else:
            part, known = known, None
        s = np.concatenate([s[:-1], part.s])
        q = np.ascontiguousarray(np.vstack([q[:-1], part.q]))
        if part.complete:
            return s, q, spans
        at = float(s[-1])
        window = None
        if len(spans) < _MOST_WINDOWS and near_singular(tracked, reference, at, q[-1]):
            window = bridge(tracked, reference, part)
        if window is None or window.s[-1] <= at:
            raise TrackingFailed(at, q[-1].copy())
        first = len(s) - len(part.s) + window.first
        s = np.concatenate([s[:first], window.s])
        q = np.ascontiguousarray(np.vstack([q[:first], window.q]))
        spans.append((float(window.s[0]), float(window.s[-1])))
        if window.s[-1] >= reference.length:
            return s, q, spans
