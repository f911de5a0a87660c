"""Joint stations along a tool path, dense enough that the spline through them stays on it.

First the arm is led along the path in steps that are halved wherever they do not hold (see
:mod:`ikplan.planning.track`), from each start there is; then the self-motion of a redundant arm is
used to shorten the joint motion; then stations are added wherever the joint spline between them
leaves the path, and nowhere else.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.kinematics.arm import Arm
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Freedom, constraint_rows
from ikplan.planning.candidates import Targets, target_at
from ikplan.planning.clock import Clock
from ikplan.planning.guide import Guide, first_stations, rest_stations
from ikplan.planning.length import motion_length
from ikplan.planning.polish import polish
from ikplan.planning.stray import measured_shares, strayed_shares
from ikplan.planning.track import first_break, onto_targets, track
from ikplan.request import Tolerance
from ikplan.timing import JointLimits, JointPath

__all__ = ["Followed", "Follower", "Lost"]

Array = NDArray[np.float64]
_Way = tuple[float, Array, Array]
"""Joint motion, stations, shape (m,), and configurations, shape (m, dof)."""

_EXACT = 1e-9
_FIRST_STEPS = (0.04, 0.005)
"""Spacing of the first stations [m, or m-equivalent of a rotation]: the second where the first
turns out to have gone over a jump."""
_TRIED = 3
"""Ways that are tried to their end, shortest first."""
_JUMP = 2.0**-20
"""A joint motion on less than this share of the path, and not on the path, is a jump."""
_FINEST = 2.0**-13
"""Smallest step, as a share of the path's length."""
_DEVIATION_SHARE = 0.5
"""Share of the tolerance that the joint spline may use up."""
_MOST_STATIONS = 20_000


@dataclass(frozen=True)
class Followed:
    """Stations of a path that was followed to its end.

    Attributes:
        s: Path positions, shape (m,).
        q: Configurations, shape (m, dof) [rad or m].
        rest: Indices of the stations where the motion stops.
        waypoint: Indices of the stations of the waypoints, shape (n,).
        length: Sum of the joint distances, the move to the first station included.
        evaluations: Forward-kinematics evaluations spent.
    """

    s: Array
    q: Array
    rest: list[int]
    waypoint: NDArray[np.int64]
    length: float
    evaluations: int


class Lost(Exception):
    """The arm could not be led farther along the path.

    Attributes:
        s: Path position of the last station reached.
        q: Its configuration, shape (dof,) [rad or m].
        evaluations: Forward-kinematics evaluations spent.
        beyond: The configuration next on the path, which it cannot move on to, shape (dof,); None:
            none was found.
    """

    def __init__(self, s: float, q: Array, evaluations: int, beyond: Array | None = None) -> None:
        super().__init__(f"lost the path at {s:.6g}")
        self.s = s
        self.q = q
        self.evaluations = evaluations
        self.beyond = beyond


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
                self.arm.chain, targets, s, q, reached, lower, upper, _EXACT, redundant
            )
            evaluations += spent
            if reached == len(s) - 1:
                return s, q, evaluations
            gap = s[reached + 2] - s[reached]
            if gap < _FINEST * guide.length or len(s) > _MOST_STATIONS:
                raise Lost(float(s[reached]), q[reached].copy(), evaluations)
            self.clock.check()
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
        lower, upper = self.arm.lower, self.arm.upper
        evaluations = 0
        while True:
            self.clock.check()
            rest = rest_stations(guide, s)
            path = JointPath.through(q, self.limits, rest_at=rest)
            off = strayed_shares(
                self.arm.chain,
                guide,
                functools.partial(self.targets_at, guide),
                s,
                path,
                self.tolerance,
            )
            evaluations += len(measured_shares(self.freedom)) * (len(s) - 1)
            wide = np.flatnonzero(off > _DEVIATION_SHARE)
            if len(wide) == 0 or len(s) > _MOST_STATIONS:
                return s, q, rest, evaluations
            steps = s[wide + 1] - s[wide]
            if steps.min() < _JUMP * guide.length:
                # The joints move, the tool does not: a jump that the first steps went over.
                at = int(wide[np.argmin(steps)])
                raise Lost(float(s[at]), q[at].copy(), evaluations, q[at + 1].copy())
            middle = 0.5 * (s[wide] + s[wide + 1])
            knots = path.s_waypoints
            q_middle = np.clip(path(0.5 * (knots[wide] + knots[wide + 1])), lower, upper)
            left, spent = onto_targets(
                self.arm.chain, self.targets_at(guide, middle), q_middle, lower, upper
            )
            evaluations += spent
            bad = np.flatnonzero(left > _EXACT)
            if len(bad):
                at = int(wide[bad[0]])
                raise Lost(float(s[at]), q[at].copy(), evaluations, q[at + 1].copy())
            order = np.argsort(np.concatenate([s, middle]), kind="stable")
            s = np.concatenate([s, middle])[order]
            q = np.ascontiguousarray(np.vstack([q, q_middle])[order])


def _length(q: Array) -> float:
    """Sum of the joint distances along stations, shape (m, dof)."""
    return motion_length(q, q[0], True)
