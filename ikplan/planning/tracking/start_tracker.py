"""Tracking from single starts: through all points, or through a few of them first.

Of a long path a few of the points tell which start leads to the least joint motion, and the
self-motion that shortens it: a Newton step moves every point by a little only, so that through few
points it takes few and cheap ones, and it leads past minima that are there only because the points
are close. The points between follow in proportion, and then go back onto their targets.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import Self

import numpy as np

from ikplan.arrays import Array
from ikplan.path.curves.natural_spline import NaturalSpline
from ikplan.planning.tracking.coarse_shortening import shortened, shortened_coarse_first
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.start_copies import StartCopies, turning_joints, without_limits
from ikplan.planning.tracking.track_from import FirstPoints, track_from
from ikplan.planning.tracking.tracked_arm import EXACT, TrackedArm
from ikplan.planning.tracking.tracked_path import JointSequence, TrackingFailed, shortest_first
from ikplan.planning.tracking.tracking_kernels import first_discontinuity, project_onto_targets

__all__ = ["FEW_STARTS", "LONG", "StartTracker"]

LONG = 256
"""Points of a path from which on a few of them tell how to begin."""
FEW_STARTS = 3
"""So many starts are all tracked, where no self-motion has to be chosen."""
_FEW_POINTS = 64
"""About how many points those few are."""
_WINDING = 4
"""Where tracking through few points makes this many times as many of them, a path winds between
them: tracking through all costs no more, and shortening at few points leads to longer sequences."""
_ALIKE = 0.05
"""Where the motion through all points is longer or shorter than that through few by more than this
share, few do not stand for all."""
_KINKED = 0.01
"""Where a joint comes to its limit and leaves it, the shortest sequence has kinks, which take time;
one without may be longer by this share."""
_DIGITS = 9
"""Digits after the point to which lengths are compared."""


class StartTracker(TrackedArm):
    """Tracks tool paths from single starts."""

    def _unlimited(self) -> Self:
        """The tracker of the arm whose turning joints have no limits."""
        return replace(self, arm=without_limits(self.arm))

    def _track_from(
        self, reference: ReferencePath, q_start: Array, first: FirstPoints
    ) -> tuple[Array, Array]:
        """Return path positions and configurations from one start to the end of the path."""
        part = track_from(self, reference, q_start, first)
        if not part.complete:
            raise TrackingFailed(float(part.s[-1]), part.q[-1].copy(), way=(part.s, part.q))
        return part.s, part.q

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

    def _astray(self, reference: ReferencePath, failure: TrackingFailed) -> bool:
        """Whether tracking may have gone over to another branch before it lost the path.

        Where two branches come near each other, the middle of a step from one to the other looks
        like one of a smooth motion; its quarters do not.
        """
        if failure.way is None or len(failure.way[0]) == 1:
            return False
        s, q = failure.way
        at, every = np.repeat(s, 2)[:-1], np.repeat(q, 2, axis=0)[:-1]
        at[1::2] = 0.5 * (s[:-1] + s[1:])
        arm = without_limits(self.arm)
        targets = self.targets_at(reference, at)
        continuous, spent = first_discontinuity(
            arm.chain, targets, every, arm.lower, arm.upper, *self.met
        )
        self.clock.count(spent)
        return continuous < len(at) - 1

    def _shorten(
        self, reference: ReferencePath, s: Array, q: Array, *, coarse_first: bool = False
    ) -> Array:
        """Shorten a sequence by self-motion; whether it stays continuous, densifying shows."""
        targets = self.targets_at(reference, s[1:])
        shorten = shortened_coarse_first if coarse_first else shortened
        shorter, spent = shorten(self.arm, targets, q[1:], q[0], self.cost)
        self.clock.count(spent)
        return np.vstack([q[:1], shorter])

    def _by_few_points(
        self,
        reference: ReferencePath,
        starts: Array,
        costs: Array,
        first: FirstPoints,
        copies: StartCopies | None,
    ) -> JointSequence | None:
        """Return the sequence through all points that goes as the best one through a few of them.

        Args:
            reference: The path.
            starts: Configurations at the path's first pose, shape (c, dof) [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).
            first: The points.
            copies: Every 2 pi copy of the starts may be taken; None: the starts as they are.

        Returns:
            The sequence; None where the path is not long or winds, or none was found.
        """
        if len(first.s) <= LONG or not (first.redundant or len(starts) > FEW_STARTS):
            return None
        few = first.thinned(_FEW_POINTS)
        best = self._through_few(reference, starts, costs, few, copies)
        if best is None:
            return None
        k = best[0]
        for calm in few.ways[1:]:
            one = slice(k, k + 1)
            other = self._through_few(reference, starts[one], costs[one], calm, copies)
            # Damped self-motion counts where it leads to clearly less joint motion.
            if other is not None and other[1][0] < (1.0 - _ALIKE) * best[1][0]:
                best, first = other, replace(first, damped=True)
        length, s, q = best[1]
        before = length - self.sequence_cost(s, q)
        found: list[JointSequence] = []
        if first.redundant and (led := self._through_all(reference, s, q, first)) is not None:
            found.append(self._costed(*led, before))
        if not found or abs(found[0][0] - length) > _ALIKE * length:
            with contextlib.suppress(TrackingFailed):
                s, q = self._track_copies(reference, starts[k], first, copies)
                ways = [q]
                if first.redundant:
                    ways = [
                        self._shorten(reference, s, q, coarse_first=coarse)
                        for coarse in (False, True)
                    ]
                found += [self._costed(s, way, before) for way in ways]
        clear = (x for x in shortest_first(found) if self.first_contact(reference, *x[1:]) is None)
        return next(clear, None)

    def _through_few(
        self,
        reference: ReferencePath,
        starts: Array,
        costs: Array,
        few: FirstPoints,
        copies: StartCopies | None,
    ) -> tuple[int, JointSequence] | None:
        """Return the shortest sequence through few points, and the number of its start.

        It is None where the path winds between the points, or no start leads to its end.
        """
        best: tuple[int, JointSequence] | None = None
        for k, q_start in enumerate(starts):
            self.clock.check()
            with contextlib.suppress(TrackingFailed):
                s, q = self._track_copies(reference, q_start, few, copies)
                if best is None and len(s) > _WINDING * len(few.s):
                    return None
                before = float(costs[k]) if copies is None else copies.cost(q[0])
                if few.redundant:
                    q = self._shorten(reference, s, q)
                length = round(before + self.sequence_cost(s, q), _DIGITS)
                if best is None or length < best[1][0]:
                    best = k, (length, s, q)
        return best

    def _costed(self, s: Array, q: Array, before: float) -> JointSequence:
        """Return a sequence with its cost, after that of getting to its start."""
        return before + self.sequence_cost(s, q), s, q

    def _through_all(
        self, reference: ReferencePath, s: Array, q: Array, first: FirstPoints
    ) -> tuple[Array, Array] | None:
        """Lead a sequence through few points through all of them; None: it is not continuous."""
        arm, at = self.arm, first.s
        # By a smooth curve: kinks would stay, and take time.
        every = np.clip(NaturalSpline(s, q)(at[1:]), arm.lower, arm.upper)
        targets = self.targets_at(reference, at[1:])
        left, spent = project_onto_targets(arm.chain, targets, every, arm.lower, arm.upper)
        self.clock.count(spent)
        if left.max() > EXACT:
            return None
        smooth = np.vstack([q[:1], every])
        shorter = self._shorten(reference, at, smooth)
        ways = [smooth, shorter] if self._at_limits(shorter) else [shorter]
        most = (1.0 + _KINKED) * self.sequence_cost(at, shorter)
        for way in ways:
            broken, spent = first_discontinuity(
                arm.chain, first.targets, way, arm.lower, arm.upper, EXACT, EXACT
            )
            self.clock.count(spent)
            if broken == len(at) - 1 and self.sequence_cost(at, way) <= most:
                return at, way
        return None

    def _at_limits(self, q: Array) -> bool:
        """Whether joints are at their limits on a part of a sequence."""
        inner = q[1:-1]
        return bool(((inner <= self.arm.lower) | (inner >= self.arm.upper)).any())
