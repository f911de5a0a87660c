"""Motions that are longer than a given time by the rounding of their timing alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ikplan.timing.jerk.within_limits import ROUNDING
from ikplan.timing.span import SpanTiming
from ikplan.timing.timed_path import TimedPath

__all__ = ["ROUNDED", "ending_at"]

ROUNDED = 1e-8
"""What an engine's rounding, and the share by which limits are kept, lengthen a motion by at most,
as a share of its duration."""
_SAME = 1e-12


def ending_at(timed: TimedPath, duration: float) -> TimedPath | None:
    """Return the motion in a time that it exceeds by rounding alone; None: that is not possible.

    The timing of a span is kept below its limits by a small share, and toppra's programs have
    tolerances. The compiled solution on the same grid, taken up to the limits, has neither.

    Args:
        timed: The motion.
        duration: The time [s], > 0.

    Returns:
        The motion, within its limits over all intervals.
    """
    if not duration < timed.duration <= duration * (1.0 + ROUNDED):
        return None
    if timed.jerk_limited:
        # Every jerk-limited motion is below its limits by this share at least.
        within = timed.duration <= duration * (1.0 + ROUNDING + _SAME)
        return _quickened(timed, duration) if within else None
    spans = [_up_to_limits(span) for span in timed.spans]
    if len(timed.s) != 1 + sum(len(span.dt) for span in spans):
        return None  # it stands somewhere for a while
    dt = np.concatenate([span.dt for span in spans])
    if float(dt.sum()) > duration * (1.0 + _SAME):
        return None
    sdot = np.sqrt(np.concatenate([[0.0], *(span.x[1:] for span in spans)]))
    node_times = np.concatenate([[0.0], np.cumsum(dt)])
    faster = replace(timed, spans=tuple(spans), sdot=sdot, node_times=node_times)
    return faster.lasting(duration)


def _up_to_limits(span: SpanTiming) -> SpanTiming:
    """Return the compiled timing of a span on its grid, as fast as its limits allow."""
    problem = span.problem
    x = problem.kept(problem.compiled_solution, 0.0)
    if len(problem.rests):
        problem.forget()
    return replace(span, x=x, dt=problem.times(x), engine="CompiledEngine")


def _quickened(timed: TimedPath, duration: float) -> TimedPath:
    return timed.slowed(duration / timed.duration).lasting(duration)
