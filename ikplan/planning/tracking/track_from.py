"""Tracking from one configuration, in steps that are halved wherever they do not hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.reference_path import ReferencePath, initial_points, turn_between
from ikplan.planning.tracking.tracked_arm import TrackedArm, most_points
from ikplan.planning.tracking.tracking_kernels import NO_EXTRA_OFFSET, track_points

__all__ = ["FirstPoints", "TrackedPart", "first_points", "track_from"]


_FINEST, _FINEST_STEP, _FINEST_TURN = 2.0**-13, 1e-4, 1e-2
"""Smallest step: as a share of the path's length, at most in all [m], and the turn in it [rad]."""
_BEND = 0.01
"""How far joints may turn back within the smallest step [rad or m]."""


@dataclass(frozen=True)
class FirstPoints:
    """The points that tracking begins with, the same from every start.

    Attributes:
        s: Path positions, shape (m,).
        targets: Their targets.
        redundant: Whether the arm has self-motion along the path.
    """

    s: Array
    targets: Targets
    redundant: bool


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
    return FirstPoints(s, tracked.targets_at(reference, s), tracked.redundant(reference))


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
        )
        tracked.clock.count(spent)
        if reached == len(s) - 1:
            return TrackedPart(s, q, complete=True)
        tracked.clock.check()
        gap = s[reached + 2] - s[reached]
        finest = gap < min(_FINEST * reference.length, _FINEST_STEP)
        if finest and tracked.oriented:
            finest = turn_between(reference, s[reached], s[reached + 2]) < _FINEST_TURN
        if finest or len(s) > most:
            # Over a sharp bend, or a jump: whether the arm can move so, densifying shows.
            these = slice(reached, reached + 3)
            over, spent = track_points(
                tracked.arm.chain, tracked.targets_at(reference, s[these]), s[these], q[these], 0,
                lower, upper, *tracked.met, redundant, _BEND,
            )  # fmt: skip
            tracked.clock.count(spent)
            if over == 0:
                end = reached + 1
                return TrackedPart(s[:end], q[:end], complete=False)
            reached += over
            continue
        halves = 0.5 * (s[reached : reached + 2] + s[reached + 1 : reached + 3])
        places = [reached + 1, reached + 2]
        s = np.insert(s, places, halves)
        q = np.vstack([q[: reached + 1], np.empty((len(s) - reached - 1, q.shape[1]))])
        targets = _inserted(targets, places, tracked.targets_at(reference, halves))


def _inserted(targets: Targets, places: list[int], further: Targets) -> Targets:
    """Insert further targets before places."""
    return Targets(
        np.insert(targets.R, places, further.R, axis=0),
        np.insert(targets.p, places, further.p, axis=0),
        np.insert(targets.oriented, places, further.oriented),
        np.insert(targets.weight, places, further.weight),
        targets.freedom,
    )
