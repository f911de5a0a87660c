"""Tracking from one configuration, in steps that are halved wherever they do not hold."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.reference_path import ReferencePath, initial_points, turn_between
from ikplan.planning.tracking.tracked_arm import TrackedArm, most_points
from ikplan.planning.tracking.tracking_kernels import NO_EXTRA_OFFSET, track_points

Rows = TypeVar("Rows", Array, Flags)

__all__ = ["FirstPoints", "TrackedPart", "first_points", "track_from"]


_FINEST, _FINEST_STEP, _FINEST_TURN = 2.0**-13, 1e-4, 1e-2
"""Smallest step: as a share of the path's length, at most in all [m], and the turn in it [rad]."""
_MANY, _CLOSE = 64, 3.0
"""More points than this, and than this many times as many as the spacing asks for, are close."""
_BEND = 0.01
"""How far joints may turn back within the smallest step [rad or m]."""


@dataclass(frozen=True)
class FirstPoints:
    """The points that tracking begins with, the same from every start.

    Attributes:
        s: Path positions, shape (m,).
        targets: Their targets.
        redundant: Whether the arm has self-motion along the path.
        finest: Step, as a share of the path's length, below which none is halved; None: the
            finest there is, and fine in rotation too.
        close: Whether there are many, and closer than their spacing asks for, as waypoints may be.
        damped: Whether self-motion away from limits does not carry on from step to step: through
            many close points it may become much longer than the path asks for.
        between: Targets of points added so far, by the path positions of each two: from other
            starts the same are added.
    """

    s: Array
    targets: Targets
    redundant: bool
    finest: float | None = None
    close: bool = False
    damped: bool = False
    between: dict[tuple[float, float], Targets] = field(default_factory=dict, compare=False)

    @property
    def ways(self) -> tuple[FirstPoints, ...]:
        """The points, and where there is self-motion through close ones, with it damped."""
        return (self, replace(self, damped=True)) if self.close and self.redundant else (self,)

    def thinned(self, count: int) -> FirstPoints:
        """Return about so many of the points: an even number of steps, the last point included."""
        stride = max(1, (len(self.s) - 1) // count)
        last = len(self.s) - 1
        rows = np.append(np.arange(0, last - stride + 1, stride), last)
        if len(rows) % 2 == 0:
            rows = np.insert(rows, -1, (rows[-2] + last) // 2)
        t = self.targets
        some = Targets(
            np.ascontiguousarray(t.R[rows]),
            np.ascontiguousarray(t.p[rows]),
            t.oriented[rows],
            t.weight[rows],
            t.freedom,
        )
        return replace(self, s=self.s[rows], targets=some)


def first_points(
    tracked: TrackedArm, reference: ReferencePath, step: float, begin: float = 0.0
) -> FirstPoints:
    """Return the points that tracking begins with.

    Args:
        tracked: The arm, and what it has to keep.
        reference: The path.
        step: Their spacing [m].
        begin: Path position to begin from.
    """
    s = initial_points(reference, step, begin)
    close = len(s) > max(_MANY, _CLOSE * reference.length / step)
    targets, redundant = tracked.targets_at(reference, s), tracked.redundant(reference)
    return FirstPoints(s, targets, redundant, close=close)


@dataclass(frozen=True)
class TrackedPart:
    """A path as far as it was tracked.

    Attributes:
        s: Path positions, shape (m,).
        q: Configurations, shape (m, dof) [rad or m].
        complete: Whether the last point is the end of the path.
    """

    s: Array
    q: Array
    complete: bool


def track_from(
    tracked: TrackedArm,
    reference: ReferencePath,
    q_start: Array,
    first: FirstPoints,
) -> TrackedPart:
    """Track a path from one configuration, as far as that goes.

    Args:
        tracked: The arm, and what it has to keep.
        reference: The path.
        q_start: The configuration at the first point, shape (dof,) [rad or m].
        first: The points to begin with.

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    lower, upper = tracked.arm.lower, tracked.arm.upper
    s, targets, redundant = first.s, first.targets, first.redundant
    q = np.empty((len(s), tracked.arm.dof))
    q[0] = q_start
    reached, most = 0, most_points(len(s))
    while True:
        reached, spent = track_points(
            tracked.arm.chain,
            targets,
            s,
            q,
            reached,
            lower,
            upper,
            *tracked.met,
            redundant,
            NO_EXTRA_OFFSET,
            first.damped,
        )
        tracked.clock.count(spent)
        if reached == len(s) - 1:
            return TrackedPart(s, q, complete=True)
        tracked.clock.check()
        gap = s[reached + 2] - s[reached]
        if first.finest is not None:
            finest = gap < first.finest * reference.length
        else:
            finest = gap < min(_FINEST * reference.length, _FINEST_STEP)
        if finest and first.finest is None and tracked.oriented:
            finest = turn_between(reference, s[reached], s[reached + 2]) < _FINEST_TURN
        if finest or len(s) > most:
            # Over a sharp bend, or a jump: whether the arm can move so, densifying shows.
            these = slice(reached, reached + 3)
            over, spent = track_points(
                tracked.arm.chain, tracked.targets_at(reference, s[these]), s[these], q[these], 0,
                lower, upper, *tracked.met, redundant, _BEND, first.damped,
            )  # fmt: skip
            tracked.clock.count(spent)
            if over == 0:
                end = reached + 1
                return TrackedPart(s[:end], q[:end], complete=False)
            reached += over
            continue
        halves = 0.5 * (s[reached : reached + 2] + s[reached + 1 : reached + 3])
        s = _halved(s, reached, halves)
        q = np.vstack([q[: reached + 1], np.empty((len(s) - reached - 1, q.shape[1]))])
        places = float(halves[0]), float(halves[1])
        further = first.between.get(places)
        if further is None:
            further = first.between[places] = tracked.targets_at(reference, halves)
        targets = Targets(
            _halved(targets.R, reached, further.R),
            _halved(targets.p, reached, further.p),
            _halved(targets.oriented, reached, further.oriented),
            _halved(targets.weight, reached, further.weight),
            targets.freedom,
        )


def _halved(rows: Rows, k: int, halves: Rows) -> Rows:
    """Return rows with one more in each of the two steps after row k, as numpy.insert has them."""
    longer = np.empty((len(rows) + 2, *rows.shape[1:]), dtype=rows.dtype)
    longer[: k + 1] = rows[: k + 1]
    longer[k + 1], longer[k + 2], longer[k + 3] = halves[0], rows[k + 1], halves[1]
    longer[k + 4 :] = rows[k + 2 :]
    return longer
