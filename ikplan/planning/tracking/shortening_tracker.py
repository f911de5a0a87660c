"""Sequences along a path made shorter, and ways around what keeps some of them from it.

Where tracking moves an arm away from its limits, the self-motion carries on from step to step, and
through many close points it may wander. Shortening takes that back, but not where contact keeps
it, nor out of every local minimum.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

import numpy as np

from ikplan.planning.tracking.global_tracker import TRIED, GlobalTracker
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.through_waypoints import whole_sequences
from ikplan.planning.tracking.track_from import FirstPoints, track_from
from ikplan.planning.tracking.tracked_path import JointSequence, shortest_first

__all__ = ["ShorteningTracker"]

_WANDERING = 1.3
"""A sequence this many times as long as that with damped self-motion wanders."""


class ShorteningTracker(GlobalTracker):
    """Shortens what was tracked from the starts."""

    def _shorten_all(
        self, reference: ReferencePath, sequences: list[JointSequence], *, wandering: bool = False
    ) -> list[JointSequence]:
        """Return the sequences made shorter where that keeps clear of contact, shortest first.

        Args:
            reference: The path.
            sequences: Sequences from the begin to the end of the path, clear of contact.
            wandering: Whether they wander, and only undamped self-motion leads to the end.

        Returns:
            The sequences; where they wander so, or contact keeps one of them from being made
            shorter, also ones from the same starts that are chosen over points of the whole path.
        """
        shorter: list[JointSequence] = []
        held = wandering and self.contact is not None
        for length, s, q in sequences:
            self.clock.check()
            q_short = self._shorten(reference, s, q)
            if self.first_contact(reference, s, q_short) is not None:
                held, q_short = True, q
            saved = self.sequence_cost(s, q) - self.sequence_cost(s, q_short)
            shorter.append((length - saved, s, q_short))
        if held:
            shorter += self._around(reference, sequences)
        return shortest_first(shorter)

    def _wanders(
        self, reference: ReferencePath, sequence: JointSequence, first: FirstPoints
    ) -> bool:
        """Whether a sequence is much longer than that with damped self-motion from its start."""
        _, s, q = sequence
        if len(first.ways) == 1:
            return False
        part = track_from(self, reference, q[0], replace(first, damped=True))
        least = self.sequence_cost(s, q) / _WANDERING
        return part.complete and self.sequence_cost(part.s, part.q) < least

    def _around(
        self, reference: ReferencePath, sequences: list[JointSequence]
    ) -> list[JointSequence]:
        """Return sequences from the same starts that are chosen over points of the whole path."""
        starts = np.array([q[0] for _, _, q in sequences])
        costs = np.array([length - self.sequence_cost(s, q) for length, s, q in sequences])
        over_points = self._over_points(reference, starts, costs)
        for found in chain(over_points, self._flooded(reference, starts, costs, sparse=True)):
            whole = whole_sequences(self, reference, found[:TRIED])
            if whole:
                return whole
        return []
