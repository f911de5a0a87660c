"""Sequences along a path made shorter, and ways around what keeps some of them from it."""

from __future__ import annotations

from itertools import chain

import numpy as np

from ikplan.planning.tracking.global_tracker import TRIED, GlobalTracker
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.through_waypoints import whole_sequences
from ikplan.planning.tracking.tracked_path import JointSequence, shortest_first

__all__ = ["ShorteningTracker"]


class ShorteningTracker(GlobalTracker):
    """Shortens what was tracked from the starts."""

    def _shorten_all(
        self, reference: ReferencePath, sequences: list[JointSequence], *, wandering: bool = False
    ) -> list[JointSequence]:
        """Return the sequences made shorter where that keeps clear of contact, shortest first.

        Args:
            reference: The path.
            sequences: Sequences from the begin to the end of the path, clear of contact.
            wandering: Whether only undamped self-motion kept them clear of contact, or went on.

        Returns:
            The sequences; where they wander, or contact keeps one of them from being made shorter,
            also ones from the same starts that are chosen over points of the whole path.
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

    def _around(
        self, reference: ReferencePath, sequences: list[JointSequence]
    ) -> list[JointSequence]:
        """Return sequences from the same starts that are chosen over points of the whole path."""
        starts = np.array([q[0] for _, _, q in sequences])
        costs = np.array([length - self.sequence_cost(s, q) for length, s, q in sequences])
        over_points = self._over_points(reference, starts, costs)
        for found in chain(over_points, self._flooded(reference, starts, sparse=True)):
            whole = whole_sequences(self, reference, found[:TRIED])
            if whole:
                return whole
        return []
