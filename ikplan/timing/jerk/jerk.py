"""Jerk-limited timing: closed forms, and motions played as fast as the limits allow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint, PathPoints
from ikplan.timing.constraints.interval_points import FINE, highest
from ikplan.timing.engines.engine import Check, EngineFailed, unlimited
from ikplan.timing.jerk.cubic_kernels import times_of
from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.smoothing import JointDemand, Smoothing
from ikplan.timing.jerk.straight import straight_motion
from ikplan.timing.jerk.warp import fastest
from ikplan.timing.problem import SpanProblem

__all__ = ["Smoothed", "smooth_span", "smooth_span_alike"]

Array = NDArray[np.float64]

# Windows tried, as multiples of the time in which the jerk limit builds up the acceleration limit
# of the slowest joint, at most the duration: with that, a short move has four equal phases.
_WINDOWS = (0.3, 0.5, 0.8, 1.2, 2.0)
# Shares of the acceleration that the jerk limit lets a swing reach, where that is less than the
# acceleration limit: the time-optimal speed to be smoothed is then found for these.
_SOFTNESS = (1.0, 0.5)
# The window where no jerk is limited, as a share of the duration.
_SHORT = 0.01
# All windows are tried for some rounds, those that lead then for the rest.
_FIRST_ROUNDS, _LEADING, _ROUNDS = 4, 2, 16
# Paths with large grids are searched less: intervals times rounds.
_EFFORT = 60_000
_FINE_POINTS = 12
_INSIDE = 1e-7
# Kept below the limits: they are measured at points of intervals, not between them.
_MARGIN = 1e-4
# The same for a closed form, so that rounding in a sample cannot step over a limit.
_ROUNDING = 2e-9
# The window of the motion to begin with, as one of the multiples above.
_FIRST_WINDOW = 1.2
# Jerk limits hardly matter where the motion takes so many times as long as accelerations take to
# build up.
_WEAK = 100.0


@dataclass(frozen=True, eq=False)
class Smoothed:
    """A jerk-limited motion, and how it was found.

    Attributes:
        motion: The motion.
        softness: Share of the acceleration that a swing over the duration would build up, to
            which accelerations were limited; None: they were not.
        window: The window, as a multiple of the time in which the jerk limits build up the
            acceleration limits where it is longest; inf: the duration; None: the motion is a
            closed form, or was played along its course.
    """

    motion: CubicMotion
    softness: float | None
    window: float | None

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return float(self.motion.time[-1])


def smooth_span(problem: SpanProblem, check: Check = unlimited) -> Smoothed:
    """Time a span within jerk limits, on the same geometric path.

    A straight line of the joint space has a closed form. Else the time-optimal path speed is
    smoothed by a moving average over time, slowed where it exceeds limits, and then played along
    its own course as fast as the limits allow (see fastest): a local optimum, on a grid. Where
    jerk limits hardly matter, several ways of smoothing are tried as well, and the best is kept.

    Args:
        problem: The span, with continuous curvature where jerks are limited, and its limits.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.

    Raises:
        EngineFailed: There is no timing even without jerk limits.
    """
    demand = _demand(problem)
    straight = _straight(problem, demand)
    if straight is not None and straight[1]:
        return straight[0]
    found = [] if straight is None else [straight[0]]
    x = problem.twin / max(problem.slowdown(problem.twin), 1e-300)
    duration = float(problem.times(x).sum())
    build_up = _build_up(problem, duration)
    search = Smoothing(problem, x, min(_FIRST_WINDOW * build_up[1], duration), demand)
    search.run(_FIRST_ROUNDS, check)
    assert search.best is not None  # the first round has made one
    motion = fastest(problem, search.best, build_up[1], demand, check)
    found.append(Smoothed(_within_limits(problem, motion, demand), None, None))
    if duration > _WEAK * build_up[1]:
        found.append(_smoothed(problem, demand, check))
    return min(found, key=lambda each: each.duration)


def _straight(problem: SpanProblem, demand: JointDemand) -> tuple[Smoothed, bool] | None:
    """Return the closed form, and whether it is optimal; None: there is none."""
    motion = straight_motion(problem)
    if motion is None:
        return None
    slower = _within_limits(problem, motion, demand, _ROUNDING)
    factor = float(slower.time[-1] / motion.time[-1])
    return Smoothed(slower, None, None), factor <= 1.0 + 10.0 * _ROUNDING


def _smoothed(problem: SpanProblem, demand: JointDemand, check: Check) -> Smoothed:
    """Return the best motion of several ways of smoothing the time-optimal path speed."""
    best = _best_window(problem, demand, None, None, check)
    for share in _SOFTNESS:
        soft = _softer(problem, share, best.duration)
        if soft is None:
            continue
        try:
            found = _best_window(soft, demand, share, None, check)
        except EngineFailed:
            continue
        best = min(best, found, key=lambda smoothed: smoothed.duration)
    return replace(best, motion=_within_limits(problem, best.motion, demand))


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
    demand, best = _demand(problem), None
    if known.window is None:
        straight = _straight(problem, demand)
        if straight is not None and straight[1]:
            return straight[0]
        build_up = _build_up(problem, known.duration)
        motion = fastest(problem, known.motion, build_up[1], demand, check)
        return Smoothed(_within_limits(problem, motion, demand), None, None)
    duration = known.duration
    # The swing goes with the duration, which is known after the first time only.
    for _ in range(1 if known.softness is None else 2):
        soft = None
        if known.softness is not None:
            soft = _softer(problem, known.softness, duration)
        found = _best_window(soft or problem, demand, known.softness, known.window, check)
        best = found if best is None else min(best, found, key=lambda s: s.duration)
        duration = best.duration
    assert best is not None  # the loop has made one
    return replace(best, motion=_within_limits(problem, best.motion, demand))


def _demand(problem: SpanProblem) -> JointDemand:
    return JointDemand(problem.path, problem.profile, problem.path.third_derivatives())


def _softer(problem: SpanProblem, share: float, duration: float) -> SpanProblem | None:
    """Return the problem with less acceleration; None: it would be the same."""
    profile = problem.profile
    reached = 0.25 * share * profile.jerk * duration
    weaker = replace(
        profile,
        acceleration=np.minimum(profile.acceleration, reached),
        acceleration_lower=np.maximum(profile.acceleration_lower, -reached),
    )
    if np.array_equal(weaker.acceleration, profile.acceleration):
        return None
    return problem.within(weaker)


def _build_up(problem: SpanProblem, duration: float) -> tuple[float, float]:
    """Return the least and the greatest time in which jerks build up accelerations on the span."""
    span, profile = np.unique(problem.grid.pieces), problem.profile
    limit = np.minimum(profile.acceleration, -profile.acceleration_lower)
    times = (limit / profile.jerk)[span].max(axis=1)
    # Where no jerk is limited, accelerations still change within some time, a short one.
    times[times == 0.0] = _SHORT * duration
    return float(times.min()), float(times.max())


def _windows(problem: SpanProblem, duration: float, only: float | None) -> dict[float, float]:
    """Return the windows to be tried [s], and what Smoothed calls them."""
    shortest, longest = _build_up(problem, duration)
    multiples = [only] if only is not None else [*reversed(_WINDOWS)]
    if only is None and shortest < 0.5 * longest:
        multiples += [multiple * shortest / longest for multiple in reversed(_WINDOWS)]
    windows = {min(multiple * longest, duration): multiple for multiple in multiples}
    if duration < 2.0 * max(windows):
        windows[duration] = np.inf
    return windows


def _best_window(
    problem: SpanProblem,
    demand: JointDemand,
    softness: float | None,
    only: float | None,
    check: Check,
) -> Smoothed:
    """Return the shortest motion found with any window; ``only``: with that one."""
    check()
    x = problem.twin / max(problem.slowdown(problem.twin), 1e-300)
    windows = _windows(problem, float(problem.times(x).sum()), only)
    searches = {m: Smoothing(problem, x, window, demand) for window, m in windows.items()}
    rounds = min(max(_EFFORT // len(problem.h), 6), _ROUNDS)
    for search in searches.values():
        search.run(_FIRST_ROUNDS, check)
    leading = sorted(searches, key=lambda m: searches[m].duration)[:_LEADING]
    for multiple in leading:
        searches[multiple].run(rounds - _FIRST_ROUNDS, check)
    best = min(leading, key=lambda m: searches[m].duration)
    motion = searches[best].best
    assert motion is not None  # the first round has made one
    return Smoothed(motion, softness, best)


def _within_limits(
    problem: SpanProblem, motion: CubicMotion, demand: JointDemand, margin: float = _MARGIN
) -> CubicMotion:
    """Slow a motion by what it exceeds its limits, looked at in finer steps."""
    path = problem.path
    times = times_of(motion.time, motion.s, motion.v, motion.a, path.s_knots)
    motion = motion.divided(times)
    top = demand(motion, _FINE_POINTS, motion.s[[0, -1]])
    motion = motion.slowed(float(top[0]) * (1.0 + margin))
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
    top = 1.0
    for constraint in constraints:
        inside = np.flatnonzero((s[2] > constraint.start) & (s[2] < constraint.end))
        if len(inside):
            at = s[:, inside].ravel()
            points = PathPoints(at, *path.derivatives(at), path.length)
            index = np.arange(len(at))
            demand = constraint.at(points).demand(index, u[:, inside].ravel(), x[:, inside].ravel())
            most = highest(demand.reshape(len(FINE), len(inside), -1))
            top = max(top, float(most.max()) * (1.0 + _MARGIN))
    return motion.slowed(float(np.sqrt(top)))
