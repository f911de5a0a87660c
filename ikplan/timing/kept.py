"""The last look at a motion: limits kept at the very samples that are handed out."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ikplan.timing.constraints import PathConstraint
from ikplan.timing.engine import Check, unlimited
from ikplan.timing.sampling import Samples, sample, with_nodes
from ikplan.timing.timed_path import TimedPath

__all__ = ["sampled_within_limits"]

Array = NDArray[np.float64]

# What a motion is slowed by beyond its excess, ten times more each time: what exceeds a limit at
# one rate of samples need not be what exceeds it at the next.
_FIRST_STEP = 1e-9
# A sample this near to the end of a range, as a share of the duration, is at the end.
_EDGE = 1e-9


def sampled_within_limits(
    timed: TimedPath,
    rate_hz: float,
    constraints: Sequence[PathConstraint] = (),
    nodes: bool = False,
    check: Check = unlimited,
) -> tuple[TimedPath, Samples]:
    """Sample a motion, and slow it by what its samples still exceed limits.

    A timing looks at its limits at points of every interval of its grid and allows for what may
    be between. Nothing is left to be slowed then, but for paths that are wilder between points
    than they show; this makes sure. It ends: a motion slowed by what it exceeds its limits
    anywhere exceeds none at any sample.

    Args:
        timed: The motion.
        rate_hz: Samples per second [Hz].
        constraints: Limits other than those of single joints; those are bounded over intervals.
        nodes: Whether the nodes of the motion are samples too.
        check: Is called before each look, and may end it by an error of its own.

    Returns:
        The motion, slower if need be, and its samples.

    Raises:
        InvalidRequest: The rate is out of range, or the motion too long for it.
        TimingFailed: Not even rest keeps a torque limit at a sample.
    """
    step = _FIRST_STEP
    while True:
        check()
        samples = with_nodes(timed, rate_hz) if nodes else sample(timed, rate_hz)
        top = max((_used(timed, samples, c) for c in constraints), default=0.0)
        if top <= 1.0:
            return timed, samples
        timed = timed.slowed(math.sqrt(top) * (1.0 + step))
        step *= 10.0


def _used(timed: TimedPath, samples: Samples, constraint: PathConstraint) -> float:
    """Return how far a constraint is used at the samples in its range."""
    first, last = timed.times_at(np.array([constraint.start, constraint.end]))
    time, edge = samples.time, _EDGE * timed.duration
    inside = (time > first + edge) & (time < last - edge)
    # The samples at rest are of the first and of the last range.
    inside[0] |= constraint.start <= 0.0
    inside[-1] |= constraint.end >= timed.path.length
    if not inside.any():
        return 0.0
    used = constraint.used(samples.q[inside], samples.dq[inside], samples.ddq[inside])
    return float(used.max())
