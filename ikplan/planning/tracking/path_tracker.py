"""Joint stations along a tool path, dense enough that the spline through them stays on it.

First the arm tracks the path from each start, in steps that are halved wherever they do not hold
(see :mod:`ikplan.planning.tracking.tracking_kernels`); then the self-motion of a redundant arm
shortens the joint motion; then stations are added wherever the joint spline between them leaves
the path, and nowhere else.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.ladder.path_shortening import polish
from ikplan.planning.tracking.densify import densify
from ikplan.planning.tracking.global_redundancy import resolve_redundancy_globally
from ikplan.planning.tracking.reference_path import (
    ReferencePath,
    first_stations,
    nearest_stations,
    turn_between,
)
from ikplan.planning.tracking.tracked_arm import EXACT, MOST_STATIONS, TrackedArm
from ikplan.planning.tracking.tracked_path import TrackedPath, TrackingFailed
from ikplan.planning.tracking.tracking_kernels import NO_EXTRA_OFFSET, first_discontinuity, track

__all__ = ["PathTracker"]

Array = NDArray[np.float64]
_Way = tuple[float, Array, Array]
"""Joint motion, stations, shape (m,), and configurations, shape (m, dof)."""

_FIRST_STEPS = (0.04, 0.005)
"""Spacing of the first stations [m, or m-equivalent of a rotation]: the second where the first
turns out to have gone over a jump."""
_CHOSEN_STEPS = ((0.05, 0.01), (0.01, 0.003))
"""Least spacing of the stations that ways are chosen over [m], also as a share of the path."""
_TRIED = 3
"""Ways that are tried to their end, shortest first."""
_FINEST, _FINEST_STEP, _FINEST_TURN = 2.0**-13, 1e-4, 1e-2
"""Smallest step: as a share of the path's length, at most in all [m], and the turn in it [rad]."""
_BEND = 0.01
"""How far joints may turn back within the smallest step [rad or m]."""


class PathTracker(TrackedArm):
    """Leads an arm along tool paths."""

    def follow(self, guide: ReferencePath, starts: Array, costs: Array) -> TrackedPath:
        """Lead the arm along a tool path.

        Args:
            guide: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).

        Returns:
            The stations of the way with the least joint motion.

        Raises:
            TrackingFailed: No start leads to the end of the path; of the one that got farthest.
            InvalidRequest: The path takes more stations than there may be.
            BudgetExceeded: The time budget ran out.
        """
        redundant = self.redundant(guide)
        evaluations = 0
        broken: TrackingFailed | None = None
        for step in _FIRST_STEPS:
            ways, lost, spent = self._ways(guide, starts, costs, step)
            evaluations += spent
            broken = _farther(broken, lost)
            if not ways:
                break  # smaller steps were tried where it was lost
            if redundant:
                ways, spent = self._shortened(guide, ways[:_TRIED])
                evaluations += spent
            try:
                followed = self._first_whole(guide, ways[:_TRIED])
            except TrackingFailed as later:
                evaluations += later.evaluations
                broken = _farther(broken, later)
                continue
            return replace(followed, evaluations=followed.evaluations + evaluations)
        if broken is None:
            raise ValueError("no start was given")
        broken.evaluations = evaluations
        raise broken

    def track_global(self, guide: ReferencePath, starts: Array, costs: Array) -> TrackedPath:
        """Lead a redundant arm along a tool path on a way chosen over the whole of it at once.

        Args:
            guide: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).

        Returns:
            The stations of the first way found.

        Raises:
            TrackingFailed: None was found, or the arm has no self-motion to choose from.
            InvalidRequest: The path takes more stations than there may be.
            BudgetExceeded: The time budget ran out.
        """
        evaluations = 0
        for step, share in _CHOSEN_STEPS if self.redundant(guide) else ():
            ways, spent = self._chosen(guide, starts, costs, max(step, share * guide.length))
            evaluations += spent
            if not ways:
                continue
            try:
                followed = self._first_whole(guide, ways[:_TRIED])
            except TrackingFailed as lost:
                evaluations += lost.evaluations
                continue
            return replace(followed, evaluations=followed.evaluations + evaluations)
        raise TrackingFailed(0.0, starts[0].copy(), evaluations)

    def _first_whole(self, guide: ReferencePath, ways: list[_Way]) -> TrackedPath:
        """The first of some ways that holds between its stations, else the farthest lost."""
        broken: list[TrackingFailed] = []
        evaluations = 0
        for length, s_way, q_way in ways:
            try:
                s, q, rest, spent = densify(self, guide, s_way, q_way)
            except TrackingFailed as lost:
                evaluations += lost.evaluations
                broken.append(lost)
                continue
            waypoint = nearest_stations(s, guide.waypoint_s)
            return TrackedPath(s, q, rest, waypoint, length, evaluations + spent)
        farthest = max(broken, key=lambda lost: lost.s)
        farthest.evaluations = evaluations
        raise farthest

    def _ways(
        self, guide: ReferencePath, starts: Array, costs: Array, step: float
    ) -> tuple[list[_Way], TrackingFailed | None, int]:
        """Lead the arm from each start: ways, shortest first, the farthest lost; evaluations."""
        ways: list[_Way] = []
        farthest: TrackingFailed | None = None
        evaluations = 0
        for q_start, cost in zip(starts, costs, strict=True):
            self.clock.check()
            try:
                s, q, spent = self._lead(guide, q_start, step)
            except TrackingFailed as lost:
                evaluations += lost.evaluations
                farthest = _farther(farthest, lost)
                continue
            evaluations += spent
            ways.append((float(cost) + _length(q), s, q))
        return sorted(ways, key=lambda way: way[0]), farthest, evaluations

    def _chosen(
        self, guide: ReferencePath, starts: Array, costs: Array, step: float
    ) -> tuple[list[_Way], int]:
        """Choose ways over all stations at once, from the nearest starts, shortest first."""
        s = first_stations(guide, step)
        targets = self.targets_at(guide, s)
        ways: list[_Way] = []
        evaluations = 0
        for k in np.argsort(costs, kind="stable")[:_TRIED]:
            found, spent = resolve_redundancy_globally(self.arm, targets, starts[k], self.clock)
            evaluations += spent
            for length, q in found:
                broken, spent = first_discontinuity(
                    self.arm.chain, targets, q, self.arm.lower, self.arm.upper, EXACT
                )
                evaluations += spent
                if broken == len(s) - 1:
                    ways.append((float(costs[k]) + length, s, q))
        return sorted(ways, key=lambda way: way[0]), evaluations

    def _lead(self, guide: ReferencePath, q_start: Array, step: float) -> tuple[Array, Array, int]:
        """Return stations and configurations from one start to the end of the path."""
        lower, upper = self.arm.lower, self.arm.upper
        s = first_stations(guide, step)
        q = np.empty((len(s), self.arm.dof))
        q[0] = q_start
        targets = self.targets_at(guide, s)
        redundant = self.redundant(guide)
        reached, evaluations = 0, 0
        while True:
            reached, spent = track(
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
            evaluations += spent
            if reached == len(s) - 1:
                return s, q, evaluations
            self.clock.check()
            gap = s[reached + 2] - s[reached]
            finest = gap < min(_FINEST * guide.length, _FINEST_STEP)
            if finest and self.oriented:
                finest = turn_between(guide, s[reached], s[reached + 2]) < _FINEST_TURN
            if finest or len(s) > MOST_STATIONS:
                # Over a sharp bend, or a jump: whether the arm can move so, densifying shows.
                these = slice(reached, reached + 3)
                over, spent = track(
                    self.arm.chain, self.targets_at(guide, s[these]), s[these], q[these], 0,
                    lower, upper, EXACT, redundant, _BEND,
                )  # fmt: skip
                evaluations += spent
                if over == 0:
                    raise TrackingFailed(float(s[reached]), q[reached].copy(), evaluations)
                reached += over
                continue
            halves = 0.5 * (s[reached : reached + 2] + s[reached + 1 : reached + 3])
            s = np.sort(np.concatenate([s, halves]))
            q = np.vstack([q[: reached + 1], np.empty((len(s) - reached - 1, q.shape[1]))])
            targets = self.targets_at(guide, s)

    def _shortened(self, guide: ReferencePath, ways: list[_Way]) -> tuple[list[_Way], int]:
        """The ways made shorter, shortest first, and the evaluations spent."""
        shorter: list[_Way] = []
        evaluations = 0
        for length, s, q in ways:
            self.clock.check()
            q_short, spent = self._shorten(guide, s, q)
            evaluations += spent
            shorter.append((length - _length(q) + _length(q_short), s, q_short))
        return sorted(shorter, key=lambda way: way[0]), evaluations

    def _shorten(self, guide: ReferencePath, s: Array, q: Array) -> tuple[Array, int]:
        """Shorten the way by the arm's self-motion; whether it stays one way, densifying shows."""
        shorter = q[1:].copy()
        _, evaluations = polish(
            self.arm.chain,
            self.targets_at(guide, s[1:]),
            shorter,
            q[0],
            False,
            self.arm.lower,
            self.arm.upper,
            30,
            1e-4,
        )
        return np.vstack([q[:1], shorter]), evaluations


def _farther(a: TrackingFailed | None, b: TrackingFailed | None) -> TrackingFailed | None:
    """Whichever was lost later on the path; the first of those lost at one place."""
    return b if a is None or (b is not None and b.s > a.s) else a


def _length(q: Array) -> float:
    """Sum of the joint distances along stations, shape (m, dof)."""
    return joint_path_length(q, q[0], True)
