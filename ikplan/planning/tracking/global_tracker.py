"""Sequences along a path chosen over points of the whole path at once, around what is in the way.

Of waypoints and corners close to one another most may be missing in them; see
:mod:`ikplan.planning.tracking.through_waypoints`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.around.dodge import dodged_sequence
from ikplan.planning.around.flood import flooded_sequences
from ikplan.planning.tracking.global_redundancy import resolve_redundancy_globally
from ikplan.planning.tracking.reference_path import ReferencePath, initial_points
from ikplan.planning.tracking.start_tracker import StartTracker
from ikplan.planning.tracking.tracked_arm import EXACT
from ikplan.planning.tracking.tracked_path import JointSequence
from ikplan.planning.tracking.tracking_kernels import first_discontinuity

__all__ = ["TRIED", "GlobalTracker"]

_STEPS = ((0.05, 0.01), (0.01, 0.003))
"""Least spacing of the points that sequences are chosen over [m], also as a share of the path."""
TRIED = 3
"""Sequences that are made dense, shortest first."""


class GlobalTracker(StartTracker):
    """Chooses sequences over points of the whole path."""

    def _over_points(
        self, reference: ReferencePath, starts: Array, costs: Array
    ) -> Iterator[list[JointSequence]]:
        """Yield sequences chosen over ever more points; first, around what is in the way.

        Args:
            reference: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).
        """
        for step, share in _STEPS:
            spacing = max(step, share * reference.length)
            s = initial_points(reference, spacing, apart=spacing)
            if self.contact is not None:
                q = dodged_sequence(self, reference, starts, costs, s)
                yield [] if q is None else [self._from_start(s, q, starts, costs)]
            yield self._resolve_globally(reference, starts, costs, s)

    def _flooded(
        self, reference: ReferencePath, starts: Array, costs: Array, *, sparse: bool = False
    ) -> Iterator[list[JointSequence]]:
        """Yield sequences where few ways lead around what is in the way, by ever denser floods."""
        if self.contact is not None:
            for s, q in flooded_sequences(self, reference, starts, sparse=sparse):
                yield [self._from_start(s, q, starts, costs)]

    def _from_start(self, s: Array, q: Array, starts: Array, costs: Array) -> JointSequence:
        """Return a sequence with its cost, after that of getting to the start it begins with."""
        k = int(np.abs(starts - q[0]).max(axis=1).argmin())
        return self._costed(s, q, float(costs[k]))

    def _resolve_globally(
        self, reference: ReferencePath, starts: Array, costs: Array, s: Array
    ) -> list[JointSequence]:
        """Choose sequences over points ``s`` at once, from the nearest starts, shortest first."""
        targets = self.targets_at(reference, s)
        sequences: list[JointSequence] = []
        for k in np.argsort(costs, kind="stable")[:TRIED]:
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
