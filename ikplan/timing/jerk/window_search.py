"""Jerk-limited motions by smoothing the time-optimal path speed: which window is best."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ikplan.timing.engines.engine import Check, EngineFailed
from ikplan.timing.jerk.smoothed import Smoothed
from ikplan.timing.jerk.smoothing import JointSlowdown, Smoothing
from ikplan.timing.jerk.within_limits import within_limits
from ikplan.timing.problem import SpanProblem

__all__ = ["build_up", "smoothed", "smoothed_alike"]

# Windows tried, as multiples of the time in which the jerk limit builds up the acceleration limit
# of the slowest joint, at most the duration: with that, a short move has four equal phases.
_WINDOWS = (0.3, 0.5, 0.8, 1.2, 2.0)
# Fractions of the acceleration that the jerk limit lets a swing reach, where that is less than the
# acceleration limit: the time-optimal speed to be smoothed is then found for these.
_ACCELERATION_FRACTIONS = (1.0, 0.5)
# The window where no jerk is limited, as a share of the duration.
_SHORT = 0.01
# All windows are tried for some rounds, those that lead then for the rest.
_FIRST_ROUNDS, _LEADING, _ROUNDS = 4, 2, 16
# Paths with large grids are searched less: intervals times rounds.
_EFFORT = 60_000


def smoothed(problem: SpanProblem, slowdown: JointSlowdown, check: Check) -> Smoothed:
    """Smooth the time-optimal path speed over time by several windows, and keep the best.

    A moving average bounds the jerk of a change of acceleration by its step over the window.
    Where the result still exceeds a limit, the path is timed again with the motion slowed there
    and within the window about it, until nothing is exceeded by much; the rest is taken from the
    whole.

    Args:
        problem: The span and its limits.
        slowdown: What judges motions by the limits of the joints.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.

    Raises:
        EngineFailed: There is no timing even without jerk limits.
    """
    best = _best_window(problem, slowdown, None, None, check)
    for fraction in _ACCELERATION_FRACTIONS:
        weaker = _with_less_acceleration(problem, fraction, best.duration)
        if weaker is None:
            continue
        try:
            found = _best_window(weaker, slowdown, fraction, None, check)
        except EngineFailed:
            continue
        best = min(best, found, key=lambda smoothed: smoothed.duration)
    return replace(best, motion=within_limits(problem, best.motion, slowdown))


def smoothed_alike(
    problem: SpanProblem, known: Smoothed, slowdown: JointSlowdown, check: Check
) -> Smoothed:
    """Smooth a path speed in the way that was best for nearly the same limits.

    Args:
        problem: The span and its limits.
        known: What was best for a problem that is much like this one, found by smoothed.
        slowdown: What judges motions by the limits of the joints.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.

    Raises:
        EngineFailed: There is no timing even without jerk limits.
    """
    best = None
    duration = known.duration
    # The swing goes with the duration, which is known after the first time only.
    for _ in range(1 if known.acceleration_fraction is None else 2):
        weaker = None
        if known.acceleration_fraction is not None:
            weaker = _with_less_acceleration(problem, known.acceleration_fraction, duration)
        found = _best_window(
            weaker or problem, slowdown, known.acceleration_fraction, known.window, check
        )
        best = found if best is None else min(best, found, key=lambda s: s.duration)
        duration = best.duration
    assert best is not None  # the loop has made one
    return replace(best, motion=within_limits(problem, best.motion, slowdown))


def _with_less_acceleration(
    problem: SpanProblem, fraction: float, duration: float
) -> SpanProblem | None:
    """Return the problem with less acceleration; None: it would be the same."""
    profile = problem.profile
    reached = 0.25 * fraction * profile.jerk * duration
    weaker = replace(
        profile,
        acceleration=np.minimum(profile.acceleration, reached),
        acceleration_lower=np.maximum(profile.acceleration_lower, -reached),
    )
    if np.array_equal(weaker.acceleration, profile.acceleration):
        return None
    return problem.within(weaker)


def build_up(problem: SpanProblem, duration: float) -> tuple[float, float]:
    """Return the least and the greatest time in which jerks build up accelerations on the span."""
    span, profile = np.unique(problem.grid.pieces), problem.profile
    limit = np.minimum(profile.acceleration, -profile.acceleration_lower)
    times = (limit / profile.jerk)[span].max(axis=1)
    # Where no jerk is limited, accelerations still change within some time, a short one.
    times[times == 0.0] = _SHORT * duration
    return float(times.min()), float(times.max())


def _windows(problem: SpanProblem, duration: float, only: float | None) -> dict[float, float]:
    """Return the windows to be tried [s], and what Smoothed calls them."""
    shortest, longest = build_up(problem, duration)
    multiples = [only] if only is not None else [*reversed(_WINDOWS)]
    if only is None and shortest < 0.5 * longest:
        multiples += [multiple * shortest / longest for multiple in reversed(_WINDOWS)]
    windows = {min(multiple * longest, duration): multiple for multiple in multiples}
    if duration < 2.0 * max(windows):
        windows[duration] = np.inf
    return windows


def _best_window(
    problem: SpanProblem,
    slowdown: JointSlowdown,
    acceleration_fraction: float | None,
    only: float | None,
    check: Check,
) -> Smoothed:
    """Return the shortest motion found with any window; ``only``: with that one."""
    check()
    x = problem.compiled_solution / max(problem.largest_ratio(problem.compiled_solution), 1e-300)
    windows = _windows(problem, float(problem.times(x).sum()), only)
    searches = {m: Smoothing(problem, x, window, slowdown) for window, m in windows.items()}
    rounds = min(max(_EFFORT // len(problem.h), 6), _ROUNDS)
    for search in searches.values():
        search.run(_FIRST_ROUNDS, check)
    leading = sorted(searches, key=lambda m: searches[m].duration)[:_LEADING]
    for multiple in leading:
        searches[multiple].run(rounds - _FIRST_ROUNDS, check)
    best = min(leading, key=lambda m: searches[m].duration)
    motion = searches[best].best
    assert motion is not None  # the first round has made one
    return Smoothed(motion, acceleration_fraction, best)
