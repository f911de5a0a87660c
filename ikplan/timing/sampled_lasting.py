"""Samples of a motion that lasts as long as asked for, or as it must."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from ikplan.errors import TimingFailed
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.engine import Check, unlimited
from ikplan.timing.sampled_within_limits import constraint_ratio, joint_ratio
from ikplan.timing.sampling import MAX_SAMPLES, Samples, check_rate, periods, samples_at
from ikplan.timing.timed_path import TimedPath

__all__ = ["sampled_lasting"]

_FIRST_STEP = 1e-9
_ROUNDS = 12
_ROUNDING = 5e-10
"""What a ratio may be above 1 by, where nothing can be slowed: at an end that moves."""
_SAME = 1e-12


def sampled_lasting(
    lasting: Callable[[float], TimedPath],
    least: float,
    rate_hz: float,
    constraints: Sequence[PathConstraint] = (),
    *,
    duration: float | None = None,
    aligned: bool = True,
    nodes: bool = False,
    check: Check = unlimited,
) -> tuple[TimedPath, Samples, float]:
    """Sample a motion that can last as long as asked for, slowed until its samples keep limits.

    Args:
        lasting: Returns the motion that takes a given time [s].
        least: Its least duration [s].
        rate_hz: Samples per second [Hz].
        constraints: Limits other than those of single joints.
        duration: The time that it has to take [s]; None: as little as it can.
        aligned: Whether it ends at a multiple of the period, where no duration is asked for.
        nodes: Whether the nodes of the motion are samples too.
        check: Is called before each look, and may end it by an error of its own.

    Returns:
        The motion, its samples, and its least duration with all samples within limits [s].

    Raises:
        InvalidRequest: The rate is out of range.
        TimingFailed: The duration is less than the least one, or the samples exceed limits however
            slow the motion is.
    """
    check_rate(rate_hz)
    step, top = _FIRST_STEP, math.inf
    for _ in range(_ROUNDS):
        check()
        wanted = duration
        if wanted is None:
            wanted = periods(least, rate_hz) / rate_hz if aligned else least
        if least > wanted * (1.0 + _SAME):
            raise TimingFailed(
                f"the motion takes {least:.9g} s at least, not {wanted:.9g} s",
                nearest={"limits": {"duration": least}},
            )
        if not wanted * rate_hz <= MAX_SAMPLES:
            raise TimingFailed(
                f"a motion of {wanted:.6g} s has more than {MAX_SAMPLES} samples at {rate_hz:g} Hz"
            )
        timed = lasting(wanted)
        samples = samples_at(timed, rate_hz, nodes=nodes)
        ratio = max(
            [
                joint_ratio(timed, samples),
                *(constraint_ratio(timed, samples, c) for c in constraints),
            ]
        )
        if ratio <= 1.0 + _ROUNDING:
            return timed, samples, least
        top = min(top, ratio)
        least = max(least, wanted if duration is None else least) * math.sqrt(ratio) * (1.0 + step)
        step *= 10.0
    raise TimingFailed(f"the samples exceed a limit by a factor of {top:.9g} however slow")
