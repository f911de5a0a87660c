"""Samples of a timed path at a controller's period."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.timing.timed_path import TimedPath
from ikplan.timing.unrounded import ROUNDED, ending_at

__all__ = [
    "MAX_RATE_HZ",
    "MAX_SAMPLES",
    "Samples",
    "check_rate",
    "on_grid",
    "periods",
    "sample",
    "sample_at_nodes",
    "samples_at",
    "with_nodes",
]


MAX_RATE_HZ = 10_000.0
MAX_SAMPLES = 250_000
# Times within this share of a period are one.
_SAME = 1e-6
# A duration this little above a whole number of periods, as a share of it, is that number.
_ROUNDING = 1e-12


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


def periods(duration: float, rate_hz: float) -> int:
    """Return the least whole number of periods that a duration [s] fits into."""
    return math.ceil(duration * rate_hz * (1.0 - _ROUNDING))


def on_grid(timed: TimedPath, rate_hz: float) -> TimedPath:
    """Slow a motion by the least factor that lets it end at a multiple of the period.

    Controllers take one sample a cycle: a motion that ends between two would end at a jump, or
    late. A motion that ends late by the rounding of its timing alone ends in time.

    Args:
        timed: The motion.
        rate_hz: Samples per second [Hz], > 0, at most 10,000.

    Returns:
        The motion, its duration a whole number of periods; one of length zero as it is.

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
    if timed.duration == 0.0:
        return timed
    count = periods(timed.duration, rate_hz)
    fewer = periods(timed.duration * (1.0 - ROUNDED), rate_hz)
    if 0 < fewer < count:
        sooner = ending_at(timed, fewer / rate_hz)
        if sooner is not None:
            return sooner
    return timed.lasting(count / rate_hz)


def sample(timed: TimedPath, rate_hz: float) -> Samples:
    """Sample a motion at multiples of the period, its end among them.

    The motion is slowed to end there, see :func:`on_grid`. The last sample has the exact last
    waypoint and zero velocity. A motion of length zero is one sample.

    Args:
        timed: The motion.
        rate_hz: Samples per second [Hz], > 0, at most 10,000.

    Returns:
        The samples.

    Raises:
        InvalidRequest: As by :func:`on_grid`.
    """
    timed = on_grid(timed, rate_hz)
    return _samples(timed, np.arange(periods(timed.duration, rate_hz) + 1) / rate_hz)


def with_nodes(timed: TimedPath, rate_hz: float) -> Samples:
    """Sample a motion at multiples of the period, its end among them, and at its nodes.

    Args:
        timed: The motion; it is slowed as by :func:`sample`.
        rate_hz: Samples per second [Hz].

    Returns:
        The samples; of those within a millionth of a period of each other, the first.

    Raises:
        InvalidRequest: As by sample.
    """
    timed = on_grid(timed, rate_hz)
    times = sample(timed, rate_hz).time
    times = np.union1d(times, timed.node_times[timed.node_times < times[-1]])
    end = times[-1]
    kept = [0.0]
    for time in times[1:-1]:
        if min(time - kept[-1], end - time) > _SAME / rate_hz:
            kept.append(float(time))
    return _samples(timed, np.array([*kept, end] if end > 0.0 else kept))


def samples_at(timed: TimedPath, rate_hz: float, *, nodes: bool) -> Samples:
    """Sample a motion at multiples of the period, and at its end wherever that is.

    Args:
        timed: The motion.
        rate_hz: Samples per second [Hz].
        nodes: Whether its nodes are samples too.

    Returns:
        The samples; of those within a millionth of a period of each other, the first; the last
        one is that of the end.
    """
    end = timed.duration
    times = np.arange(periods(end, rate_hz) + 1) / rate_hz
    if nodes:
        times = np.union1d(times, timed.node_times)
    kept = [0.0]
    for time in times[1:]:
        if min(time - kept[-1], end - time) > _SAME / rate_hz:
            kept.append(float(time))
    return _samples(timed, np.array([*kept, end] if end > 0.0 else kept))


def _samples(timed: TimedPath, time: Array) -> Samples:
    q, dq, ddq = timed.evaluate(time)
    q[-1] = timed.path.q_knots[-1]
    if timed.sdot[-1] == 0.0:
        dq[-1] = 0.0
    return Samples(time, q, dq, ddq)


def sample_at_nodes(timed: TimedPath) -> Samples:
    """Return the motion at its nodes, and nothing between.

    Between nodes the path acceleration is constant; in a jerk-limited motion, linear.

    Args:
        timed: The motion.

    Returns:
        Samples at the times of the nodes, the last one exact and at rest.
    """
    return _samples(timed, timed.node_times)
