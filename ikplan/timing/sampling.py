"""Samples of a timed path at a controller's period."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest
from ikplan.timing.timed_path import TimedPath

__all__ = ["MAX_RATE_HZ", "MAX_SAMPLES", "Samples", "check_rate", "knots", "sample", "with_nodes"]

Array = NDArray[np.float64]

MAX_RATE_HZ = 10_000.0
MAX_SAMPLES = 250_000
# Times within this share of a period are one.
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class Samples:
    """A joint trajectory as samples.

    Attributes:
        time: Times [s], shape (m,), strictly increasing from 0.
        q: Joint positions, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof) [rad/s or m/s].
        ddq: Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2].
    """

    time: Array
    q: Array
    dq: Array
    ddq: Array


def check_rate(rate_hz: float) -> None:
    """Refuse a sampling rate that no controller runs at.

    Args:
        rate_hz: Samples per second [Hz].

    Raises:
        InvalidRequest: The rate is not above 0 and at most 10,000.
    """
    if not 0.0 < rate_hz <= MAX_RATE_HZ:
        raise InvalidRequest(
            f"rate_hz must be above 0 and at most {MAX_RATE_HZ:g} Hz, not {rate_hz!r}",
            field="sampling.rate_hz",
            allowed=f"0 < rate_hz <= {MAX_RATE_HZ:g}",
        )


def sample(timed: TimedPath, rate_hz: float) -> Samples:
    """Sample a motion at multiples of the period, and at its end.

    The last sample is at the duration exactly, with the exact last waypoint and zero velocity.
    The one before it is dropped when it is nearer than half a period, so that the last step is
    between a half and one and a half periods long, and all others one. A motion shorter than
    half a period is slowed to take half a period. A motion of length zero is one sample.

    Args:
        timed: The motion.
        rate_hz: Samples per second [Hz], > 0, at most 10,000.

    Returns:
        The samples.

    Raises:
        InvalidRequest: The rate is out of range, or the motion too long for it.
    """
    check_rate(rate_hz)
    if not timed.duration * rate_hz <= MAX_SAMPLES:
        raise InvalidRequest(
            f"a motion of {timed.duration:.4g} s at {rate_hz:g} Hz has more than {MAX_SAMPLES} "
            f"samples; a rate of at most {MAX_SAMPLES / timed.duration:.3g} Hz would do, or a "
            "faster motion",
            field="sampling.rate_hz",
            allowed=f"at most {MAX_SAMPLES} samples",
        )
    if 0.0 < timed.duration < 0.5 / rate_hz:
        timed = timed.slowed(0.5 / rate_hz / timed.duration)
    duration = timed.duration
    # Multiples of the period, up to the last one at least half a period before the end.
    count = max(math.floor(duration * rate_hz - 0.5 + 1e-9) + 1, 1)
    time = np.arange(count) / rate_hz
    if duration > 0.0:
        time = np.append(time, duration)
    return _samples(timed, time)


def with_nodes(timed: TimedPath, rate_hz: float) -> Samples:
    """Sample a motion at multiples of the period, at its nodes, and at its end.

    Args:
        timed: The motion.
        rate_hz: Samples per second [Hz].

    Returns:
        The samples; of those within a millionth of a period of each other, the first.

    Raises:
        InvalidRequest: As by sample.
    """
    times = sample(timed, rate_hz).time
    times = np.union1d(times, timed.node_times[timed.node_times < times[-1]])
    end = times[-1]
    kept = [0.0]
    for time in times[1:-1]:
        if min(time - kept[-1], end - time) > _SAME / rate_hz:
            kept.append(float(time))
    return _samples(timed, np.array([*kept, end] if end > 0.0 else kept))


def _samples(timed: TimedPath, time: Array) -> Samples:
    q, dq, ddq = timed.evaluate(time)
    q[-1] = timed.path.q_knots[-1]
    dq[-1] = 0.0
    return Samples(time, q, dq, ddq)


def knots(timed: TimedPath) -> Samples:
    """Return the motion at its nodes, and nothing between.

    Between nodes the path acceleration is constant; in a jerk-limited motion, linear.

    Args:
        timed: The motion.

    Returns:
        Samples at the times of the nodes, the last one exact and at rest.
    """
    return _samples(timed, timed.node_times)
