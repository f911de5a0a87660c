"""Path points along a tool path, dense enough that the joint spline through them stays on it.

First the arm tracks the path from each start, in steps that are halved wherever they do not hold
(see :mod:`ikplan.planning.tracking.tracking_kernels`); then the self-motion of a redundant arm
shortens the joint motion; then points are added wherever the joint spline between them leaves
the path, and nowhere else.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.check import Contact
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.planning.tracking.densify import densify
from ikplan.planning.tracking.dodge import dodged_sequence
from ikplan.planning.tracking.global_redundancy import resolve_redundancy_globally
from ikplan.planning.tracking.reference_path import (
    ReferencePath,
    initial_points,
    nearest_points,
    turn_between,
)
from ikplan.planning.tracking.tracked_arm import EXACT, MAX_POINTS, TrackedArm
from ikplan.planning.tracking.tracked_path import TrackedPath, TrackingFailed
from ikplan.planning.tracking.tracking_kernels import (
    NO_EXTRA_OFFSET,
    first_discontinuity,
    track_points,
)

__all__ = ["PathTracker"]

_JointSequence = tuple[float, Array, Array]
"""Joint path length, path positions, shape (m,), and configurations, shape (m, dof)."""

_FIRST_STEPS = (0.04, 0.005)
"""Spacing of the first points [m, or m-equivalent of a rotation]: the second where the first
turns out to have gone over a jump."""
_GLOBAL_STEPS = ((0.05, 0.01), (0.01, 0.003))
"""Least spacing of the points that sequences are chosen over [m], also as a share of the path."""
_TRIED = 3
"""Sequences that are made dense, shortest first."""
_FINEST, _FINEST_STEP, _FINEST_TURN = 2.0**-13, 1e-4, 1e-2
"""Smallest step: as a share of the path's length, at most in all [m], and the turn in it [rad]."""
_BEND = 0.01
"""How far joints may turn back within the smallest step [rad or m]."""


class PathTracker(TrackedArm):
    """Tracks tool paths with an arm."""

    def track(self, reference: ReferencePath, starts: Array, costs: Array) -> TrackedPath:
        """Track a tool path.

        Args:
            reference: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).

        Returns:
            The points of the sequence with the least joint motion.

        Raises:
            TrackingFailed: No start leads to the end of the path; the failure that got farthest.
            InvalidRequest: The path takes more points than there may be.
            BudgetExceeded: The time budget ran out.
        """
        redundant = self.redundant(reference)
        broken: TrackingFailed | None = None
        for step in _FIRST_STEPS:
            sequences, failure = self._track_starts(reference, starts, costs, step)
            broken = _farthest_failure(broken, failure)
            if not sequences:
                break  # smaller steps were tried where it failed
            if redundant:
                sequences = self._shorten_all(reference, sequences[:_TRIED])
            try:
                return self._densify_first(reference, sequences[:_TRIED])
            except TrackingFailed as later:
                broken = _farthest_failure(broken, later)
        if broken is None:
            raise ValueError("no start was given")
        raise broken

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
        for step, share in _GLOBAL_STEPS if self.redundant(reference) else ():
            spacing = max(step, share * reference.length)
            for sequences in self._global_sequences(reference, starts, costs, spacing):
                if sequences:
                    with contextlib.suppress(TrackingFailed):
                        return self._densify_first(reference, sequences[:_TRIED])
        raise TrackingFailed(0.0, starts[0].copy())

    def _global_sequences(
        self, reference: ReferencePath, starts: Array, costs: Array, spacing: float
    ) -> Iterator[list[_JointSequence]]:
        """Yield sequences chosen over all points; where there are obstacles, around them first."""
        if self.contact is not None:
            s = initial_points(reference, spacing)
            q = dodged_sequence(self, reference, starts, costs, s)
            yield [] if q is None else [(_length(q), s, q)]
        yield self._resolve_globally(reference, starts, costs, spacing)

    def _densify_first(
        self, reference: ReferencePath, sequences: list[_JointSequence]
    ) -> TrackedPath:
        """The first sequence that can be made dense, else the failure that got farthest."""
        broken: list[TrackingFailed] = []
        for length, s_sequence, q_sequence in sequences:
            try:
                s, q, rest = densify(self, reference, s_sequence, q_sequence)
            except TrackingFailed as failure:
                broken.append(failure)
                continue
            if contact := self.first_contact(reference, s, q):
                broken.append(_in_contact(contact, s))
                continue
            waypoint = nearest_points(s, reference.waypoint_s)
            return TrackedPath(s, q, rest, waypoint, length)
        raise max(broken, key=lambda failure: (failure.contact is not None, failure.s))

    def _track_starts(
        self, reference: ReferencePath, starts: Array, costs: Array, step: float
    ) -> tuple[list[_JointSequence], TrackingFailed | None]:
        """Track the path from every start.

        Returns:
            Sequences, shortest first, and the failure that got farthest.
        """
        sequences: list[_JointSequence] = []
        farthest: TrackingFailed | None = None
        for q_start, cost in zip(starts, costs, strict=True):
            self.clock.check()
            try:
                s, q = self._track_from(reference, q_start, step)
            except TrackingFailed as failure:
                farthest = _farthest_failure(farthest, failure)
                continue
            if contact := self.first_contact(reference, s, q):
                farthest = _farthest_failure(farthest, _in_contact(contact, s))
                continue
            sequences.append((float(cost) + _length(q), s, q))
        return sorted(sequences, key=lambda sequence: sequence[0]), farthest

    def _resolve_globally(
        self, reference: ReferencePath, starts: Array, costs: Array, step: float
    ) -> list[_JointSequence]:
        """Choose sequences over all points at once, from the nearest starts, shortest first."""
        s = initial_points(reference, step)
        targets = self.targets_at(reference, s)
        sequences: list[_JointSequence] = []
        for k in np.argsort(costs, kind="stable")[:_TRIED]:
            free = None if self.contact is None else self.contact.free
            for length, q in resolve_redundancy_globally(
                self.arm, targets, starts[k], self.clock, free
            ):
                broken, spent = first_discontinuity(
                    self.arm.chain, targets, q, self.arm.lower, self.arm.upper, EXACT
                )
                self.clock.count(spent)
                if broken == len(s) - 1 and self.first_contact(reference, s, q) is None:
                    sequences.append((float(costs[k]) + length, s, q))
        return sorted(sequences, key=lambda sequence: sequence[0])

    def _track_from(
        self, reference: ReferencePath, q_start: Array, step: float
    ) -> tuple[Array, Array]:
        """Return path positions and configurations from one start to the end of the path."""
        lower, upper = self.arm.lower, self.arm.upper
        s = initial_points(reference, step)
        q = np.empty((len(s), self.arm.dof))
        q[0] = q_start
        targets = self.targets_at(reference, s)
        redundant = self.redundant(reference)
        reached = 0
        while True:
            reached, spent = track_points(
                self.arm.chain,
                targets,
                s,
                q,
                reached,
                lower,
                upper,
                EXACT,
                redundant,
                NO_EXTRA_OFFSET,
            )
            self.clock.count(spent)
            if reached == len(s) - 1:
                return s, q
            self.clock.check()
            gap = s[reached + 2] - s[reached]
            finest = gap < min(_FINEST * reference.length, _FINEST_STEP)
            if finest and self.oriented:
                finest = turn_between(reference, s[reached], s[reached + 2]) < _FINEST_TURN
            if finest or len(s) > MAX_POINTS:
                # Over a sharp bend, or a jump: whether the arm can move so, densifying shows.
                these = slice(reached, reached + 3)
                over, spent = track_points(
                    self.arm.chain, self.targets_at(reference, s[these]), s[these], q[these], 0,
                    lower, upper, EXACT, redundant, _BEND,
                )  # fmt: skip
                self.clock.count(spent)
                if over == 0:
                    raise TrackingFailed(float(s[reached]), q[reached].copy())
                reached += over
                continue
            halves = 0.5 * (s[reached : reached + 2] + s[reached + 1 : reached + 3])
            s = np.sort(np.concatenate([s, halves]))
            q = np.vstack([q[: reached + 1], np.empty((len(s) - reached - 1, q.shape[1]))])
            targets = self.targets_at(reference, s)

    def _shorten_all(
        self, reference: ReferencePath, sequences: list[_JointSequence]
    ) -> list[_JointSequence]:
        """Return the sequences made shorter, shortest first."""
        shorter: list[_JointSequence] = []
        for length, s, q in sequences:
            self.clock.check()
            q_short = self._shorten(reference, s, q)
            if self.first_contact(reference, s, q_short) is not None:
                q_short = q
            shorter.append((length - _length(q) + _length(q_short), s, q_short))
        return sorted(shorter, key=lambda sequence: sequence[0])

    def _shorten(self, reference: ReferencePath, s: Array, q: Array) -> Array:
        """Shorten a sequence by self-motion; whether it stays continuous, densifying shows."""
        shorter = q[1:].copy()
        _, spent = shorten_sequence(
            self.arm.chain,
            self.targets_at(reference, s[1:]),
            shorter,
            q[0],
            False,
            self.arm.lower,
            self.arm.upper,
            30,
            1e-4,
        )
        self.clock.count(spent)
        return np.vstack([q[:1], shorter])


def _in_contact(contact: Contact, s: Array) -> TrackingFailed:
    """The failure of a path that is tracked up to a contact."""
    at = float(s[contact.step])
    if contact.step + 1 < len(s):
        at += contact.share * float(s[contact.step + 1] - s[contact.step])
    return TrackingFailed(at, contact.q.copy(), contact=contact)


def _farthest_failure(a: TrackingFailed | None, b: TrackingFailed | None) -> TrackingFailed | None:
    """Whichever got farther along the path; the first of those that got equally far.

    What is tracked to the end but for contact counts before what is not: obstacles hold it alone.
    """
    if a is None or b is None:
        return b if a is None else a
    return b if (b.contact is not None, b.s) > (a.contact is not None, a.s) else a


def _length(q: Array) -> float:
    """Sum of the joint distances along points, shape (m, dof)."""
    return joint_path_length(q, q[0], True)
