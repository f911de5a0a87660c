"""Path points along a tool path, dense enough that the joint spline through them stays on it.

First the arm tracks the path from each start, in steps that are halved wherever they do not hold
(see :mod:`ikplan.planning.tracking.tracking_kernels`); then the self-motion of a redundant arm
shortens the joint motion; then points are added wherever the joint spline between them leaves
the path, and nowhere else.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Self

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.planning.around.dodge import dodged_sequence
from ikplan.planning.around.flood import flooded_sequences
from ikplan.planning.tracking.coarse_shortening import (
    LONG,
    shortened,
    shortened_coarse_first,
)
from ikplan.planning.tracking.densify import densify
from ikplan.planning.tracking.farthest_starts import COARSE, farthest_starts
from ikplan.planning.tracking.global_redundancy import resolve_redundancy_globally
from ikplan.planning.tracking.reference_path import (
    ReferencePath,
    initial_points,
    nearest_points,
)
from ikplan.planning.tracking.start_copies import StartCopies, turning_joints, without_limits
from ikplan.planning.tracking.track_from import FirstPoints, first_points, track_from
from ikplan.planning.tracking.tracked_arm import EXACT, TrackedArm
from ikplan.planning.tracking.tracked_path import (
    JointSequence,
    TrackedPath,
    TrackedStarts,
    TrackingFailed,
    farthest_failure,
    in_contact,
    shortest_first,
)
from ikplan.planning.tracking.tracking_kernels import first_discontinuity
from ikplan.planning.within.track_within import SpanList

__all__ = ["FIRST_STEPS", "PathTracker"]

FIRST_STEPS = (0.04, 0.005)
"""Spacing of the first points [m, or m-equivalent of a rotation]: the second where the first
turns out to have gone over a jump."""
_GLOBAL_STEPS = ((0.05, 0.01), (0.01, 0.003))
"""Least spacing of the points that sequences are chosen over [m], also as a share of the path."""
_TRIED = 3
"""Sequences that are made dense, shortest first."""
_FEW_POINTS = 64
"""About how many points of a long path tell which of many starts lead to short sequences."""
_WINDING = 4
"""Where tracking through few points makes this many times as many of them, a path winds between
them: tracking through all costs no more, and shortening at few points leads to longer sequences."""
_DIGITS = 9
"""Digits after the point to which lengths are compared."""


class PathTracker(TrackedArm):
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
            few = self._few_points(reference, starts, first, copies)
            for some in self._promising(reference, starts, costs, few, copies):
                tracked = self._track_starts(reference, starts[some], costs[some], first, copies)
                sequences = tracked.clear(_TRIED)
                for shortest in self._in_order(
                    reference, sequences, redundant=redundant, coarse_first=few is not None
                ):
                    try:
                        return self._densify_first(reference, shortest)
                    except TrackingFailed as later:
                        broken = farthest_failure(broken, tracked.farthest())
                        broken = farthest_failure(broken, later)
                if not sequences:
                    broken = farthest_failure(broken, tracked.farthest())
            if not sequences:
                break  # smaller steps were tried where it failed
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
            for sequences in self._global_sequences(reference, starts, costs):
                if sequences:
                    with contextlib.suppress(TrackingFailed):
                        return self._densify_first(reference, sequences[:_TRIED])
        raise TrackingFailed(0.0, starts[0].copy())

    def _global_sequences(
        self, reference: ReferencePath, starts: Array, costs: Array
    ) -> Iterator[list[JointSequence]]:
        """Yield sequences chosen over all points; where there are obstacles, around them first."""
        for step, share in _GLOBAL_STEPS:
            spacing = max(step, share * reference.length)
            if self.contact is not None:
                s = initial_points(reference, spacing)
                q = dodged_sequence(self, reference, starts, costs, s)
                yield [] if q is None else [(self.sequence_cost(s, q), s, q)]
            yield self._resolve_globally(reference, starts, costs, spacing)
        if self.contact is not None:
            for s, q in flooded_sequences(self, reference, starts):
                yield [(self.sequence_cost(s, q), s, q)]

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

    def _promising(
        self,
        reference: ReferencePath,
        starts: Array,
        costs: Array,
        few: FirstPoints | None,
        copies: StartCopies | None,
    ) -> Iterator[Indices]:
        """Yield which starts to track the path from: all; of a long path first the best one.

        From that one the motion through a few of the points is the shortest. Each of the others
        would cost as much as the whole tracking and shortening from the one.
        """
        if few is not None and len(starts) > _TRIED:
            lengths = np.full(len(starts), np.inf)
            for k, q_start in enumerate(starts):
                self.clock.check()
                with contextlib.suppress(TrackingFailed):
                    s, q = self._track_copies(reference, q_start, few, copies)
                    before = float(costs[k]) if copies is None else copies.cost(q[0])
                    if few.redundant:
                        q = self._shorten(reference, s, q, coarse_first=False)
                    lengths[k] = round(before + self.sequence_cost(s, q), _DIGITS)
            if np.isfinite(lengths.min()):
                yield np.argmin(lengths, keepdims=True)
        yield np.arange(len(starts))

    def _few_points(
        self,
        reference: ReferencePath,
        starts: Array,
        first: FirstPoints,
        copies: StartCopies | None,
    ) -> FirstPoints | None:
        """Return a few of the points of a long path; None where it winds, or nothing needs them."""
        if len(first.s) <= LONG or not (first.redundant or len(starts) > _TRIED):
            return None
        few = first.thinned(_FEW_POINTS)
        for q_start in starts:
            self.clock.check()
            with contextlib.suppress(TrackingFailed):
                s, _ = self._track_copies(reference, q_start, few, copies)
                return few if len(s) <= _WINDING * len(few.s) else None
        return few

    def _unlimited(self) -> Self:
        """The tracker of the arm whose turning joints have no limits."""
        return replace(self, arm=without_limits(self.arm))

    def _track_copies(
        self,
        reference: ReferencePath,
        q_start: Array,
        first: FirstPoints,
        copies: StartCopies | None,
    ) -> tuple[Array, Array]:
        """Track from one start, or from the copy of it that goes through and is nearest."""
        arm = self.arm
        if copies is None or not turning_joints(arm).any():
            return self._track_from(reference, q_start, first)
        s, q = self._unlimited()._track_from(reference, q_start, first)
        q, fits = copies.fitting(arm, q)
        if fits:
            return s, q
        # Self-motion may keep to the limits where it has to; otherwise this tells where they bind.
        return self._track_from(reference, q[0], first)

    def _resolve_globally(
        self, reference: ReferencePath, starts: Array, costs: Array, step: float
    ) -> list[JointSequence]:
        """Choose sequences over all points at once, from the nearest starts, shortest first."""
        s = initial_points(reference, step)
        targets = self.targets_at(reference, s)
        sequences: list[JointSequence] = []
        for k in np.argsort(costs, kind="stable")[:_TRIED]:
            free = None if self.contact is None else self.contact.free
            for length, q in resolve_redundancy_globally(
                self.arm, targets, starts[k], self.cost, self.clock, free
            ):
                broken, spent = first_discontinuity(
                    self.arm.chain, targets, q, self.arm.lower, self.arm.upper, EXACT, EXACT
                )
                self.clock.count(spent)
                if broken == len(s) - 1 and self.first_contact(reference, s, q) is None:
                    sequences.append((float(costs[k]) + length, s, q))
        return sorted(sequences, key=lambda sequence: sequence[0])

    def _track_from(
        self, reference: ReferencePath, q_start: Array, first: FirstPoints
    ) -> tuple[Array, Array]:
        """Return path positions and configurations from one start to the end of the path."""
        part = track_from(self, reference, q_start, first)
        if not part.complete:
            raise TrackingFailed(float(part.s[-1]), part.q[-1].copy())
        return part.s, part.q

    def _in_order(
        self,
        reference: ReferencePath,
        sequences: list[JointSequence],
        *,
        redundant: bool,
        coarse_first: bool,
    ) -> Iterator[list[JointSequence]]:
        """Yield what is made dense, shortest first.

        Of a redundant arm the sequences made shorter, long ones in the better way first.
        """
        if not sequences:
            return
        if not redundant:
            yield sequences
            return
        if coarse_first and any(len(s) > LONG for _, s, _ in sequences):
            yield self._shorten_all(reference, sequences, coarse_first=True)
        yield self._shorten_all(reference, sequences, coarse_first=False)

    def _shorten_all(
        self, reference: ReferencePath, sequences: list[JointSequence], *, coarse_first: bool
    ) -> list[JointSequence]:
        """Return the sequences made shorter, shortest first."""
        shorter: list[JointSequence] = []
        for length, s, q in sequences:
            q_short = q
            for coarse in (True, False) if coarse_first and len(s) > LONG else (False,):
                self.clock.check()
                q_tried = self._shorten(reference, s, q, coarse_first=coarse)
                if self.first_contact(reference, s, q_tried) is None:
                    q_short = q_tried
                    break
            saved = self.sequence_cost(s, q) - self.sequence_cost(s, q_short)
            shorter.append((length - saved, s, q_short))
        return shortest_first(shorter)

    def _shorten(
        self, reference: ReferencePath, s: Array, q: Array, *, coarse_first: bool
    ) -> Array:
        """Shorten a sequence by self-motion; whether it stays continuous, densifying shows."""
        targets = self.targets_at(reference, s[1:])
        shorten = shortened_coarse_first if coarse_first else shortened
        shorter, spent = shorten(self.arm, targets, q[1:], q[0], self.cost)
        self.clock.count(spent)
        return np.vstack([q[:1], shorter])
