"""Leading the joints straight on where exact tracking past a singularity costs a flip."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, lengths_of, steps_of
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.track_from import TrackedPart
from ikplan.planning.tracking.tracked_arm import TrackedArm
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.within.tolerance_window import near_singular
from ikplan.planning.within.track_within import SpanList, track_within

__all__ = ["straightened"]


_SPAN = 0.01
"""Length of path over which a flip happens [m]."""
_FLIP = 1.0
"""Joint motion within that length from which on it counts as a flip [rad or m]."""
_SAVED = 0.5
"""Joint motion that leaving the path has to save [rad or m]."""
_MOST = 4
"""Flips of a path that are led over."""


def straightened(
    tracked: TrackedArm, reference: ReferencePath, s: Array, q: Array, step: float
) -> tuple[Array, Array, SpanList] | None:
    """Track a path that was tracked exactly once more, within the tolerance over its flips.

    Args:
        tracked: The arm, and what it has to keep within the tolerance.
        reference: The path.
        s: Path positions of the points tracked, shape (m,).
        q: Their configurations, shape (m, dof) [rad or m].
        step: Spacing of the first points [m].

    Returns:
        Path positions, configurations, and the parts that leave the path; None
        where there is no flip, or none that the tolerance saves.

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    best: tuple[Array, Array, SpanList] | None = None
    passed = 0.0
    for _ in range(_MOST):
        place = _flip(tracked, reference, s, q, passed)
        if place is None:
            break
        part = TrackedPart(s[: place + 1], q[: place + 1], complete=False)
        spans = [] if best is None else best[2]
        passed = float(s[place]) + _SPAN
        try:
            s_new, q_new, more = track_within(tracked, reference, q[0], step, part)
        except TrackingFailed:
            continue
        if _length(q_new) < _length(q) - _SAVED:
            s, q = s_new, q_new
            kept = [span for span in spans if span[1] <= more[0][0]]
            best = s, q, [*kept, *more]
    return best


def _flip(
    tracked: TrackedArm, reference: ReferencePath, s: Array, q: Array, passed: float
) -> int | None:
    """Index of the point where the first flip behind a path position is fastest, None: none."""
    moved = np.concatenate([[0.0], np.cumsum(lengths_of(steps_of(q)))])
    over = np.interp(s + _SPAN, s, moved) - moved
    begins = np.flatnonzero((over > _FLIP) & (s >= passed))
    if len(begins) == 0:
        return None
    first = int(begins[0])
    last = min(int(np.searchsorted(s, s[first] + 2.0 * _SPAN)), len(s) - 1)
    rate = steps_of(moved[first : last + 1]) / np.maximum(steps_of(s[first : last + 1]), 1e-12)
    place = first + int(np.argmax(rate)) if len(rate) else first
    near = near_singular(tracked, reference, float(s[place]), q[place])
    return place if near and 0 < place < len(s) - 1 else None


def _length(q: Array) -> float:
    return joint_path_length(np.ascontiguousarray(q), np.ascontiguousarray(q[0]), True)
