"""The final check: slow a motion until every returned sample is within its limits."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array, Indices, clamped
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.engine import Check, unlimited
from ikplan.timing.sampling import Samples, on_grid, sample, with_nodes
from ikplan.timing.timed_path import TimedPath

__all__ = ["constraint_ratio", "joint_ratio", "sampled_within_limits"]


# What a motion is slowed by beyond its ratio, ten times more each time: what exceeds a limit at
# one rate of samples need not be what exceeds it at the next.
_FIRST_STEP = 1e-9
# What a ratio is above 1 by where a motion is as fast as its limits allow.
_ROUNDING = 1e-12
# A sample this near to the end of a range, as a share of the duration, is at the end.
_EDGE = 1e-9


def sampled_within_limits(
    timed: TimedPath,
    rate_hz: float,
    constraints: Sequence[PathConstraint] = (),
    nodes: bool = False,
    check: Check = unlimited,
) -> tuple[TimedPath, Samples]:
    """Slow a motion to end at a sample, and by what its samples still exceed limits.

    A timing looks at its limits at points of every interval of its grid and allows for what may
    be between; those of single joints it bounds over intervals. Nothing is left to be slowed then,
    but for paths that are wilder between points than they show, and for the rounding of places on
    a piece that is short beside the path; this makes sure. It ends: a motion slowed by what it
    exceeds its limits anywhere exceeds none at any sample.

    Args:
        timed: The motion.
        rate_hz: Samples per second [Hz].
        constraints: Limits other than those of single joints.
        nodes: Whether the nodes of the motion are samples too.
        check: Is called before each look, and may end it by an error of its own.

    Returns:
        The motion, its duration a whole number of periods, and its samples.

    Raises:
        InvalidRequest: The rate is out of range, or the motion too long for it.
        TimingFailed: Not even rest keeps a torque limit at a sample.
    """
    step = _FIRST_STEP
    while True:
        check()
        gridded = on_grid(timed, rate_hz)
        # What ends a rounding sooner than it was timed to is at its limits, not below them.
        most = 1.0 + _ROUNDING if gridded.duration < timed.duration else 1.0
        timed = gridded
        samples = with_nodes(timed, rate_hz) if nodes else sample(timed, rate_hz)
        ratio = max(
            [
                joint_ratio(timed, samples),
                *(constraint_ratio(timed, samples, c) for c in constraints),
            ]
        )
        if ratio <= most:
            return timed, samples
        timed = timed.slowed(math.sqrt(ratio) * (1.0 + step))
        step *= 10.0


def constraint_ratio(timed: TimedPath, samples: Samples, constraint: PathConstraint) -> float:
    """Return a constraint's limit ratio at the samples in its range."""
    first, last = timed.times_at(np.array([constraint.start, constraint.end]))
    time, edge = samples.time, _EDGE * timed.duration
    inside = (time > first + edge) & (time < last - edge)
    # The samples at rest are of the first and of the last range.
    inside[0] |= constraint.start <= 0.0
    inside[-1] |= constraint.end >= timed.path.length
    if not inside.any():
        return 0.0
    ratio = constraint.ratio(samples.q[inside], samples.dq[inside], samples.ddq[inside])
    return float(ratio.max())


def joint_ratio(timed: TimedPath, samples: Samples) -> float:
    """Return the ratio to the joints' own limits at the samples."""
    if not timed.spans or len(samples.time) < 2:
        return 0.0
    profile = timed.spans[0].problem.profile
    # At a knot the limits of either side will do.
    before, after = _pieces_at(timed, samples.time)
    v_up, a_up = (np.maximum(r[before], r[after]) for r in (profile.velocity, profile.acceleration))
    v_down, a_down = (
        np.minimum(r[before], r[after])
        for r in (profile.velocity_lower, profile.acceleration_lower)
    )
    speed = np.maximum(samples.dq / v_up, samples.dq / v_down)
    pull = np.maximum(samples.ddq / a_up, samples.ddq / a_down)
    ratio = float(max(np.square(speed.max()), pull.max()))
    if not timed.jerk_limited:
        return ratio
    jerk = np.abs(np.diff(samples.ddq, axis=0)) / np.diff(samples.time)[:, None]
    change = jerk / np.maximum(profile.jerk[after[:-1]], profile.jerk[before[1:]])
    return max(ratio, float(np.cbrt(change.max()) ** 2))


def _pieces_at(timed: TimedPath, time: Array) -> tuple[Indices, Indices]:
    """Return the pieces of the path just before and just after times, shape (m,) each."""
    jerk = timed.jerk_limited
    at = timed.positions_at(time) if jerk else time
    ends = timed.path.s_knots if jerk else timed.node_times
    edge = _EDGE * float(ends[-1])
    before, after = (
        clamped(np.searchsorted(ends, x, side="right") - 1, 0, len(ends) - 2)
        for x in (at - edge, at + edge)
    )
    return (before, after) if jerk else (timed.pieces[before], timed.pieces[after])
