"""Joint stations along a tool path, dense enough that the spline through them stays on it.

First the arm is led along the path in steps that are halved wherever they do not hold (see
:mod:`ikplan.planning.track`), from each start there is; then the self-motion of a redundant arm is
used to shorten the joint motion; then stations are added wherever the joint spline between them
leaves the path, and nowhere else.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Freedom, constraint_rows
from ikplan.planning.candidates import Targets, target_at
from ikplan.planning.clock import Clock
from ikplan.planning.followed import Followed, Lost
from ikplan.planning.guide import Guide, first_stations, rest_stations, turn_between
from ikplan.planning.length import motion_length
from ikplan.planning.polish import polish
from ikplan.planning.stray import measured_shares, strayed_shares
from ikplan.planning.track import NO_SLACK, first_break, onto_targets, track
from ikplan.request import Tolerance
from ikplan.timing import JointLimits, JointPath

__all__ = ["Follower"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
_Way = tuple[float, Array, Array]
"""Joint motion, stations, shape (m,), and configurations, shape (m, dof)."""

_EXACT = 1e-9
_FIRST_STEPS = (0.04, 0.005)
"""Spacing of the first stations [m, or m-equivalent of a rotation]: the second where the first
turns out to have gone over a jump."""
_TRIED = 3
"""Ways that are tried to their end, shortest first."""
_JUMP, _JUMP_STEP, _JUMP_TURN = 2.0**-20, 1e-6, 1e-4
"""A joint motion on less than this share of the path, this length [m] and this turn [rad], that is
not on the path is a jump."""
_FINEST, _FINEST_STEP, _FINEST_TURN = 2.0**-13, 1e-4, 1e-2
"""Smallest step: as a share of the path's length, at most in all [m], and the turn in it [rad]."""
_BEND = 0.01
"""How far joints may turn back within the smallest step [rad or m]."""
_DEVIATION_SHARE = 0.5
"""Share of the tolerance that the joint spline may use up."""
_MOST_STATIONS = 20_000


@dataclass(frozen=True)
class Follower:
    """Leads an arm along tool paths.

    Attributes:
        arm: The arm.
        limits: Its position limits.
        freedom: What need not hold along the path.
        oriented: Whether orientations count at all.
        tolerance: How far from the path the tool may be.
        clock: The time budget.
    """

    arm: Arm
    limits: JointLimits
    freedom: Freedom
    oriented: bool
    tolerance: Tolerance
    clock: Clock

    def follow(self, guide: Guide, starts: Array, costs: Array) -> Followed:
        """Lead the arm along a tool path.

        Args:
            guide: The path.
            starts: Configurations at the path's first pose, shape (c, dof), c >= 1 [rad or m].
            costs: Joint motion already spent to get to each, shape (c,).

        Returns:
            The stations of the way with the least joint motion.

        Raises:
            Lost: From no start can the path be followed to its end; of the one that got farthest.
            InvalidRequest: The path takes more stations than there may be.
            BudgetExceeded: The time budget ran out.
        """
        evaluations = 0
        broken: Lost | None = None
        for step in _FIRST_STEPS:
            ways, spent = self._ways(guide, starts, costs, step)
            evaluations += spent
            if self._redundant(guide):
                ways, spent = self._shortened(guide, ways[:_TRIED])
                evaluations += spent
            for length, s_way, q_way in ways[:_TRIED]:
                try:
                    s, q, rest, spent = self._densify(guide, s_way, q_way)
                except Lost as lost:
                    evaluations += lost.evaluations
                    if broken is None or lost.s > broken.s:
                        broken = lost
                    continue
                waypoint = np.searchsorted(s, guide.waypoint_s - 1e-12 * max(guide.length, 1.0))
                return Followed(s, q, rest, waypoint, length, evaluations + spent)
        if broken is None:
            raise ValueError("no start was given")
        broken.evaluations = evaluations
        raise broken

    def targets_at(self, guide: Guide, s: Array) -> Targets:
        """Return the targets of path positions, shape (m,)."""
        R, p = guide.poses(s)
        mask = guide.orientation_mask(s) & self.oriented
        return Targets(
            np.ascontiguousarray(R),
            np.ascontiguousarray(p),
            mask,
            np.where(mask, ORIENTATION_WEIGHT, 0.0),
            self.freedom,
        )

    def _redundant(self, guide: Guide) -> bool:
        targets = self.targets_at(guide, np.array([0.5 * guide.length]))
        return self.arm.dof > constraint_rows(target_at(targets, 0))

    def _ways(
        self, guide: Guide, starts: Array, costs: Array, step: float
    ) -> tuple[list[_Way], int]:
        """Length, stations and configurations from each start, shortest first; evaluations."""
        ways: list[_Way] = []
        farthest: Lost | None = None
        evaluations = 0
        for q_start, cost in zip(starts, costs, strict=True):
            self.clock.check()
            try:
                s, q, spent = self._lead(guide, q_start, step)
            except Lost as lost:
                evaluations += lost.evaluations
                if farthest is None or lost.s > farthest.s:
                    farthest = lost
                continue
            evaluations += spent
            ways.append((float(cost) + _length(q), s, q))
        if ways:
            return sorted(ways, key=lambda way: way[0]), evaluations
        if farthest is None:
            raise ValueError("no start was given")
        farthest.evaluations = evaluations
        raise farthest

    def _lead(self, guide: Guide, q_start: Array, step: float) -> tuple[Array, Array, int]:
        """Return stations and configurations from one start to the end of the path."""
        lower, upper = self.arm.lower, self.arm.upper
        s = first_stations(guide, step)
        q = np.empty((len(s), self.arm.dof))
        q[0] = q_start
        targets = self.targets_at(guide, s)
        redundant = self._redundant(guide)
        reached, evaluations = 0, 0
        while True:
            reached, spent = track(
                self.arm.chain, targets, s, q, reached, lower, upper, _EXACT, redundant, NO_SLACK
            )
            evaluations += spent
            if reached == len(s) - 1:
                return s, q, evaluations
            self.clock.check()
            gap = s[reached + 2] - s[reached]
            finest = gap < min(_FINEST * guide.length, _FINEST_STEP)
            if finest and self.oriented:
                finest = turn_between(guide, s[reached], s[reached + 2]) < _FINEST_TURN
            if finest or len(s) > _MOST_STATIONS:
                # Over a sharp bend, or a jump: whether the arm can move so, densifying shows.
                these = slice(reached, reached + 3)
                over, spent = track(
                    self.arm.chain, self.targets_at(guide, s[these]), s[these], q[these], 0,
                    lower, upper, _EXACT, redundant, _BEND,
                )  # fmt: skip
                evaluations += spent
                if over == 0:
                    raise Lost(float(s[reached]), q[reached].copy(), evaluations)
                reached += over
                continue
            halves = 0.5 * (s[reached : reached + 2] + s[reached + 1 : reached + 3])
            s = np.sort(np.concatenate([s, halves]))
            q = np.vstack([q[: reached + 1], np.empty((len(s) - reached - 1, q.shape[1]))])
            targets = self.targets_at(guide, s)

    def _shortened(self, guide: Guide, ways: list[_Way]) -> tuple[list[_Way], int]:
        """The ways made shorter, shortest first, and the evaluations spent."""
        shorter: list[_Way] = []
        evaluations = 0
        for length, s, q in ways:
            self.clock.check()
            q_short, spent = self._shorten(guide, s, q)
            evaluations += spent
            shorter.append((length - _length(q) + _length(q_short), s, q_short))
        return sorted(shorter, key=lambda way: way[0]), evaluations

    def _shorten(self, guide: Guide, s: Array, q: Array) -> tuple[Array, int]:
        """Shorten the way by the arm's self-motion, as long as it stays one way."""
        lower, upper = self.arm.lower, self.arm.upper
        shorter = np.ascontiguousarray(q[1:])
        _, evaluations = polish(
            self.arm.chain,
            self.targets_at(guide, s[1:]),
            shorter,
            q[0],
            False,
            lower,
            upper,
            30,
            1e-4,
        )
        shorter = np.vstack([q[:1], shorter])
        targets = self.targets_at(guide, s)
        broken, spent = first_break(self.arm.chain, targets, shorter, lower, upper, _EXACT)
        whole = broken == len(s) - 1
        return (shorter if whole else q), evaluations + spent

    def _densify(self, guide: Guide, s: Array, q: Array) -> tuple[Array, Array, list[int], int]:
        """Add stations until the joint spline through them stays on the path."""
        targets_at = functools.partial(self.targets_at, guide)
        evaluations = 0
        while True:
            self.clock.check()
            rest = rest_stations(guide, s)
            path = JointPath.through(q, self.limits, rest_at=rest)
            for close in (False, True):
                off = strayed_shares(
                    self.arm.chain, guide, targets_at, s, path, self.tolerance, close,
                    _DEVIATION_SHARE,
                )  # fmt: skip
                evaluations += len(measured_shares(self.freedom, close)) * (len(s) - 1)
                wide = np.flatnonzero(off > _DEVIATION_SHARE)
                if len(wide):
                    break
            if len(wide) == 0:
                return s, q, rest, evaluations
            if len(s) > _MOST_STATIONS:
                raise InvalidRequest(
                    f"path: more than {_MOST_STATIONS} joint stations are needed to keep the tool "
                    f"within {self.tolerance.position:.6g} m and "
                    f"{self.tolerance.orientation:.6g} rad of it; allow more, or send the path in "
                    "parts",
                    field="path.tolerance",
                )
            steps = s[wide + 1] - s[wide]
            at = int(wide[np.argmin(steps)])
            still = steps.min() < min(_JUMP * guide.length, _JUMP_STEP)
            if still and self.oriented:
                still = turn_between(guide, s[at], s[at + 1]) < _JUMP_TURN
            if still:
                # The joints move, the tool does not: a jump that the first steps went over.
                raise Lost(float(s[at]), q[at].copy(), evaluations, q[at + 1].copy())
            middle, q_middle, bad, spent = self._between(targets_at, s, path, wide)
            evaluations += spent
            if len(bad):
                at = int(bad[0])
                raise Lost(float(s[at]), q[at].copy(), evaluations, q[at + 1].copy())
            order = np.argsort(np.concatenate([s, middle]), kind="stable")
            s = np.concatenate([s, middle])[order]
            q = np.ascontiguousarray(np.vstack([q, q_middle])[order])

    def _between(
        self, targets_at: Callable[[Array], Targets], s: Array, path: JointPath, steps: Index
    ) -> tuple[Array, Array, Index, int]:
        """Find a station within each of some steps, about its middle.

        Returns:
            Path positions, configurations, the steps without one, and evaluations spent.
        """
        knots, lower, upper = path.s_waypoints, self.arm.lower, self.arm.upper
        middle, q = np.empty(len(steps)), np.empty((len(steps), self.arm.dof))
        evaluations, left = 0, np.arange(len(steps))
        # Where there is none in the very middle, as when just there the arm is singular: beside it.
        for share in (0.5, 0.4, 0.6):
            k = steps[left]
            middle[left] = s[k] + share * (s[k + 1] - s[k])
            tried = np.clip(path(knots[k] + share * (knots[k + 1] - knots[k])), lower, upper)
            off, spent = onto_targets(self.arm.chain, targets_at(middle[left]), tried, lower, upper)
            q[left] = tried
            evaluations += spent
            left = left[off > _EXACT]
            if len(left) == 0:
                break
        return middle, q, steps[left], evaluations


def _length(q: Array) -> float:
    """Sum of the joint distances along stations, shape (m, dof)."""
    return motion_length(q, q[0], True)
