"""Jerk-limited timing: the time-optimal path speed, smoothed over time and held back on bends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint, PathPoints
from ikplan.timing.constraints.interval_points import FINE, highest
from ikplan.timing.engines.engine import Check, EngineFailed, unlimited
from ikplan.timing.jerk.cubic_kernels import times_of
from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.smoothing import JointSlowdown, Smoothing
from ikplan.timing.problem import SpanProblem

__all__ = ["Smoothed", "smooth_span", "smooth_span_alike"]


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
_FINE_POINTS = 12
_INSIDE = 1e-7
# Kept below the limits: they are measured at points of intervals, not between them.
_MARGIN = 1e-3


@dataclass(frozen=True, eq=False)
class Smoothed:
    """A jerk-limited motion, and how it was found.

    Attributes:
        motion: The motion.
        acceleration_fraction: Fraction of the acceleration that a swing over the duration would
            build up, to which accelerations were limited; None: they were not.
        window: The window, as a multiple of the time in which the jerk limits build up the
            acceleration limits where it is longest; inf: the duration.
    """

    motion: CubicMotion
    acceleration_fraction: float | None
    window: float

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return float(self.motion.time[-1])


def smooth_span(problem: SpanProblem, check: Check = unlimited) -> Smoothed:
    """Time a span within jerk limits, on the same geometric path.

    The time-optimal path speed is smoothed by a moving average over time, which bounds the jerk of
    a change of acceleration by its step over the window. Where the result still exceeds a limit,
    the path is timed again with the motion slowed there and within the window about it, until
    nothing is exceeded by much; the rest is taken from the whole. Of several windows, the best is
    kept. The result is not the optimum: the benchmark tells the distance.

    Args:
        problem: The span, with continuous curvature where jerks are limited, and its limits.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.

    Raises:
        EngineFailed: There is no timing even without jerk limits.
    """
    slowdown = _slowdown(problem)
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
    return replace(best, motion=_within_limits(problem, best.motion, slowdown))


def smooth_span_alike(problem: SpanProblem, known: Smoothed, check: Check = unlimited) -> Smoothed:
    """Time a span within jerk limits in the way that was best for nearly the same limits.

    Args:
        problem: The span and its limits.
        known: What was best for a problem that is much like this one.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.

    Raises:
        EngineFailed: There is no timing even without jerk limits.
    """
    slowdown, best = _slowdown(problem), None
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
    return replace(best, motion=_within_limits(problem, best.motion, slowdown))


def _slowdown(problem: SpanProblem) -> JointSlowdown:
    return JointSlowdown(problem.path, problem.profile, problem.path.third_derivatives())


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


def _windows(problem: SpanProblem, duration: float, only: float | None) -> dict[float, float]:
    """Return the windows to be tried [s], and what Smoothed calls them."""
    span, profile = np.unique(problem.grid.pieces), problem.profile
    limit = np.minimum(profile.acceleration, -profile.acceleration_lower)
    build_up = (limit / profile.jerk)[span].max(axis=1)
    # Where no jerk is limited, accelerations still change within some time, a short one.
    build_up[build_up == 0.0] = _SHORT * duration
    longest, shortest = float(build_up.max()), float(build_up.min())
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


def _within_limits(
    problem: SpanProblem, motion: CubicMotion, slowdown: JointSlowdown
) -> CubicMotion:
    """Slow a motion by what it exceeds its limits, looked at in finer steps."""
    path = problem.path
    times = times_of(motion.time, motion.s, motion.v, motion.a, path.s_knots)
    motion = motion.divided(times)
    factor = slowdown(motion, _FINE_POINTS, motion.s[[0, -1]])
    motion = motion.slowed(float(factor[0]) * (1.0 + _MARGIN))
    return _within_constraints(path, motion, problem.constraints)


def _within_constraints(
    path: JointPath, motion: CubicMotion, constraints: Sequence[PathConstraint]
) -> CubicMotion:
    """Slow a motion by what it exceeds limits other than those of single joints."""
    # The ends from inside: at a knot the curvature may step.
    share = np.clip(FINE, _INSIDE, 1.0 - _INSIDE)
    dt = np.diff(motion.time)
    j = np.divide(np.diff(motion.a), dt, out=np.zeros(len(dt)), where=dt > 0.0)
    r = share[:, None] * dt
    s0, v0, a0 = motion.s[:-1], motion.v[:-1], motion.a[:-1]
    s = s0 + r * (v0 + r * (0.5 * a0 + r * j / 6.0))
    x = np.square(v0 + r * (a0 + 0.5 * r * j))
    u = a0 + r * j
    largest = 1.0
    for constraint in constraints:
        inside = np.flatnonzero((s[2] > constraint.start) & (s[2] < constraint.end))
        if len(inside):
            at = s[:, inside].ravel()
            points = PathPoints(at, *path.derivatives(at), path.length)
            index = np.arange(len(at))
            ratios = constraint.at(points).ratios(index, u[:, inside].ravel(), x[:, inside].ravel())
            most = highest(ratios.reshape(len(FINE), len(inside), -1))
            largest = max(largest, float(most.max()) * (1.0 + _MARGIN))
    return motion.slowed(float(np.sqrt(largest)))
