"""Path points along a tool path, dense enough that the joint spline through them stays on it.

First the arm tracks the path from each start, in steps that are halved wherever they do not hold
(see :mod:`ikplan.planning.tracking.tracking_kernels`); then the self-motion of a redundant arm
shortens the joint motion; then points are added wherever the joint spline between them leaves
the path, and nowhere else.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.planning.tracking.densify import densify
from ikplan.planning.tracking.farthest_starts import COARSE, farthest_starts
from ikplan.planning.tracking.global_tracker import TRIED
from ikplan.planning.tracking.reference_path import ReferencePath, nearest_points
from ikplan.planning.tracking.shortening_tracker import ShorteningTracker
from ikplan.planning.tracking.start_copies import StartCopies
from ikplan.planning.tracking.through_waypoints import whole_sequences
from ikplan.planning.tracking.track_from import FirstPoints, first_points
from ikplan.planning.tracking.tracked_path import (
    JointSequence,
    TrackedPath,
    TrackedStarts,
    TrackingFailed,
    farthest_failure,
    in_contact,
)
from ikplan.planning.within.track_within import SpanList

__all__ = ["FIRST_STEPS", "PathTracker"]

FIRST_STEPS = (0.04, 0.005)
"""Spacing of the first points [m, or m-equivalent of a rotation]: the second where the first
turns out to have gone over a jump."""


class PathTracker(ShorteningTracker):
    """Tracks tool paths with an arm."""

    def track(
        self,
        reference: ReferencePath,
        starts: Array,
        costs: Array,
        copies: StartCopies | None = None,
    ) -> TrackedPath:
        """Track a tool path.

        Args:
            reference: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).
            copies: Every 2 pi copy of the starts may be taken; their motion then counts by it.
                None: the starts as they are.

        Returns:
            The points of the sequence with the least joint motion.

        Raises:
            TrackingFailed: No start leads to the end of the path; the failure that got farthest.
            InvalidRequest: The path takes more points than there may be.
            BudgetExceeded: The time budget ran out.
        """
        redundant = self.redundant(reference)
        broken: TrackingFailed | None = None
        for step in FIRST_STEPS:
            first = first_points(self, reference, step)
            quick = self._by_few_points(reference, starts, costs, first, copies)
            if quick is not None:
                # Where it cannot be made dense, all starts are tracked.
                with contextlib.suppress(TrackingFailed):
                    return self._densify_first(reference, [quick])
            tracked = self._track_starts(reference, starts, costs, first, copies)
            sequences = tracked.clear(TRIED)
            wandering = bool(sequences) and self._wanders(reference, sequences[0], first)
            if wandering:
                calm = replace(first, damped=True)
                damped = self._track_starts(reference, starts, costs, calm, copies).clear(TRIED)
                sequences, wandering = damped + sequences, not damped
            if sequences:
                if redundant:
                    sequences = self._shorten_all(reference, sequences, wandering=wandering)
                try:
                    return self._densify_first(reference, sequences)
                except TrackingFailed as later:
                    broken = farthest_failure(broken, tracked.farthest())
                    broken = farthest_failure(broken, later)
            elif step == FIRST_STEPS[-1] or not self._any_astray(reference, tracked):
                # Smaller steps were tried where the path was lost, not before.
                broken = farthest_failure(broken, tracked.farthest())
                break
        if broken is None:
            raise ValueError("no start was given")
        raise broken

    def rough_sequences(self, reference: ReferencePath, starts: Array) -> list[JointSequence]:
        """Return sequences, shortest first, that go along a tool path from some starts.

        They are not dense yet, and keep clear of contact; a start may have none.

        Args:
            reference: The path.
            starts: Configurations at the path's first pose, shape (c, dof) [rad or m].

        Raises:
            BudgetExceeded: The time budget ran out.
        """
        costs = np.zeros(len(starts))
        first = first_points(self, reference, FIRST_STEPS[0])
        return self._track_starts(reference, starts, costs, first, None).clear()

    def farthest_starts(
        self, reference: ReferencePath, starts: Array, copies: StartCopies | None
    ) -> Indices:
        """Return the starts that lead along a tool path in coarse steps, and some that nearly do.

        Args:
            reference: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            copies: As for :meth:`track`.

        Raises:
            BudgetExceeded: The time budget ran out.
        """
        first = replace(first_points(self, reference, FIRST_STEPS[0]), finest=COARSE)
        track = partial(self._track_copies, reference, first=first, copies=copies)
        return farthest_starts(track, starts, reference.length)

    def track_global(self, reference: ReferencePath, starts: Array, costs: Array) -> TrackedPath:
        """Track a tool path with a redundant arm on a sequence chosen over all points at once.

        Args:
            reference: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).

        Returns:
            The points of the first sequence found.

        Raises:
            TrackingFailed: None was found, or the arm has no self-motion to choose from.
            InvalidRequest: The path takes more points than there may be.
            BudgetExceeded: The time budget ran out.
        """
        if self.redundant(reference):
            over_points = self._over_points(reference, starts, costs)
            for sequences in chain(over_points, self._flooded(reference, starts, costs)):
                whole = whole_sequences(self, reference, sequences[:TRIED])
                if whole:
                    with contextlib.suppress(TrackingFailed):
                        return self._densify_first(reference, whole)
        raise TrackingFailed(0.0, starts[0].copy())

    def _any_astray(self, reference: ReferencePath, tracked: TrackedStarts) -> bool:
        """Whether tracking may have gone over to another branch from one of the starts."""
        return any(self._astray(reference, failure) for failure in tracked.lost)

    def _densify_first(
        self,
        reference: ReferencePath,
        sequences: list[JointSequence],
        windows: SpanList | None = None,
    ) -> TrackedPath:
        """The first sequence that can be made dense, else the failure that got farthest."""
        broken: list[TrackingFailed] = []
        for length, s_sequence, q_sequence in sequences:
            try:
                s, q, rest = densify(self, reference, s_sequence, q_sequence, windows)
            except TrackingFailed as failure:
                broken.append(failure)
                continue
            if contact := self.first_contact(reference, s, q):
                broken.append(in_contact(contact, s))
                continue
            waypoint = nearest_points(s, reference.waypoint_s)
            return TrackedPath(s, q, rest, waypoint, length)
        raise max(broken, key=lambda failure: (failure.contact is not None, failure.s))

    def _track_starts(
        self,
        reference: ReferencePath,
        starts: Array,
        costs: Array,
        first: FirstPoints,
        copies: StartCopies | None,
    ) -> TrackedStarts:
        """Track the path from every start."""
        ends: list[JointSequence | TrackingFailed] = []
        for q_start, cost in zip(starts, costs, strict=True):
            self.clock.check()
            try:
                s, q = self._track_copies(reference, q_start, first, copies)
            except TrackingFailed as failure:
                ends.append(failure)
                continue
            before = float(cost) if copies is None else copies.cost(q[0])
            ends.append((before + self.sequence_cost(s, q), s, q))
        return TrackedStarts(ends, partial(self.first_contact, reference))
