"""Tracking tool paths within the tolerance, where exact tracking fails or costs a flip."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import Self

from ikplan.arrays import Array
from ikplan.path.tolerance_shares import left_to_tracking
from ikplan.planning.tracking.path_tracker import FIRST_STEPS, PathTracker
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.start_copies import StartCopies, turning_joints
from ikplan.planning.tracking.tracked_path import (
    JointSequence,
    TrackedPath,
    TrackingFailed,
    farthest_failure,
    shortest_first,
)
from ikplan.planning.within.leading_beside import led_beside
from ikplan.planning.within.straightening import straightened
from ikplan.planning.within.track_within import SpanList, track_within

__all__ = ["TolerantTracker"]

_TRIED_WITHIN = 8
"""Starts that are tracked within the tolerance, nearest first."""


class TolerantTracker(PathTracker):
    """Tracks tool paths with an arm, exactly or within the tolerance."""

    def track_within(
        self,
        reference: ReferencePath,
        starts: Array,
        costs: Array,
        copies: StartCopies | None = None,
    ) -> TrackedPath:
        """Track a tool path within the tolerance; arguments and errors as in :meth:`track`.

        Points are met exactly where that can be. Where a singularity ends exact tracking, the
        joints are led over it, and the tool leaves the path within the tolerance.
        """
        tracker = self.tolerant(reference)
        sequences: list[JointSequence] = []
        spans: dict[int, SpanList] = {}
        broken: TrackingFailed | None = None
        for q_start, cost in zip(starts[:_TRIED_WITHIN], costs, strict=False):
            try:
                s, q, windows = tracker._track_copies_within(reference, q_start, copies)
            except TrackingFailed as failure:
                broken = farthest_failure(broken, failure)
                continue
            before = float(cost) if copies is None else copies.cost(q[0])
            sequences.append((before + self.sequence_cost(s, q), s, q))
            spans[id(s)] = windows
        ordered = shortest_first(sequences)
        for sequence in ordered:
            try:
                return tracker._densify_first(reference, [sequence], spans[id(sequence[1])])
            except TrackingFailed as failure:
                broken = farthest_failure(broken, failure)
        for length, s, q in ordered:
            led = led_beside(tracker, reference, s, q)
            if led is not None:
                with contextlib.suppress(TrackingFailed):
                    s_led, q_led, runs = led
                    saved = self.sequence_cost(s, q) - self.sequence_cost(s_led, q_led)
                    sequence = length - saved, s_led, q_led
                    return tracker._densify_first(reference, [sequence], runs)
        assert broken is not None
        raise broken

    def straighten(self, reference: ReferencePath, tracked: TrackedPath) -> TrackedPath:
        """Return a tracked path led over its flips, or as it is where the tolerance saves none."""
        tracker = self.tolerant(reference)
        found = straightened(tracker, reference, tracked.s, tracked.q, FIRST_STEPS[0])
        if found is None:
            return tracked
        s, q, windows = found
        saved = self.sequence_cost(tracked.s, tracked.q) - self.sequence_cost(s, q)
        length = tracked.length - saved
        try:
            return tracker._densify_first(reference, [(length, s, q)], windows)
        except TrackingFailed:
            return tracked

    def tolerant(self, reference: ReferencePath) -> Self:
        """Return the tracker that tracks a path within what its corners leave of the tolerance."""
        left = left_to_tracking(reference.taken)
        tolerance = self.tolerance
        if left < 1.0:
            tolerance = tolerance.model_copy(
                update={
                    "position": left * tolerance.position,
                    "orientation": left * tolerance.orientation,
                }
            )
        return replace(self, within=True, tolerance=tolerance)

    def _track_copies_within(
        self, reference: ReferencePath, q_start: Array, copies: StartCopies | None
    ) -> tuple[Array, Array, SpanList]:
        """Track within the tolerance from one start, or from a copy of it that goes through."""
        arm, step = self.arm, FIRST_STEPS[0]
        if copies is not None and turning_joints(arm).any():
            unlimited = self._unlimited()
            s, q, windows = track_within(unlimited, reference, q_start, step)
            q, fits = copies.fitting(arm, q)
            if fits:
                return s, q, windows
            q_start = q[0]
        return track_within(self, reference, q_start, step)
