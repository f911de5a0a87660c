"""Jerk-limited timing: the time-optimal path speed, smoothed over time and held back on bends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ikplan.timing.compiled_engine import CompiledEngine
from ikplan.timing.constraints import PathConstraint, PathPoints
from ikplan.timing.cubic_kernels import moving_average, times_of
from ikplan.timing.engine import Check, EngineFailed, unlimited
from ikplan.timing.interval_points import FINE, highest
from ikplan.timing.jerk_kernels import cubic_demand, spread
from ikplan.timing.joint_path import JointPath
from ikplan.timing.problem import SpanProblem
from ikplan.timing.profile import LimitProfile
from ikplan.timing.rows import StageRows, natural_units
from ikplan.timing.span import SpanTiming

__all__ = ["CubicMotion", "smooth_span"]

Array = NDArray[np.float64]

# Windows tried, as multiples of the time in which the jerk limit builds up the acceleration limit
# of the slowest joint, at most the duration: with that, a short move has four equal phases.
_WINDOWS = (0.3, 0.5, 0.8, 1.2, 2.0)
# Shares of the acceleration that the jerk limit lets a swing reach, where that is less than the
# acceleration limit: the time-optimal speed to be smoothed is then found for these.
_SOFTNESS = (1.0, 0.5)
_ROUNDS = 16
# Paths with large grids are searched less: intervals times rounds.
_EFFORT = 60_000
# How much of a local excess is answered by slowing there at once, and when it is small enough.
_STEP = 0.5
_ENOUGH = 1.002
_POINTS, _FINE_POINTS = 3, 12
# Kept below the limits: they are measured at points of intervals, not between them.
_MARGIN = 1e-3


@dataclass(frozen=True, eq=False)
class CubicMotion:
    """A motion along a path with constant path jerk between nodes, from rest to rest.

    Attributes:
        time: Times of the nodes [s], shape (n + 1,), from 0.
        s: Path positions, shape (n + 1,).
        v: Path velocities, shape (n + 1,).
        a: Path accelerations, shape (n + 1,), zero at both ends.
    """

    time: Array
    s: Array
    v: Array
    a: Array

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """Return path positions, velocities and accelerations at times, (m,) each."""
        i = np.clip(np.searchsorted(self.time, times, side="right") - 1, 0, len(self.time) - 2)
        dt = np.diff(self.time)[i]
        j = np.divide(np.diff(self.a)[i], dt, out=np.zeros(len(i)), where=dt > 0.0)
        r = times - self.time[i]
        a = self.a[i] + r * j
        v = np.maximum(self.v[i] + r * (self.a[i] + 0.5 * r * j), 0.0)
        s = self.s[i] + r * (self.v[i] + r * (0.5 * self.a[i] + r * j / 6.0))
        return s, v, a

    def divided(self, times: Array) -> CubicMotion:
        """Return the same motion with more nodes, at given times."""
        more = np.setdiff1d(times[(times > 0.0) & (times < self.time[-1])], self.time)
        s, v, a = self.at(more)
        at = np.searchsorted(self.time, more, side="right")
        return CubicMotion(
            np.insert(self.time, at, more),
            np.maximum.accumulate(np.insert(self.s, at, s)),
            np.insert(self.v, at, v),
            np.insert(self.a, at, a),
        )

    def slowed(self, k: float) -> CubicMotion:
        """Return the motion k times slower."""
        return CubicMotion(self.time * k, self.s, self.v / k, self.a / (k * k))


def smooth_span(
    path: JointPath,
    span: SpanTiming,
    profile: LimitProfile,
    jerk: Array,
    constraints: Sequence[PathConstraint],
    check: Check = unlimited,
) -> CubicMotion:
    """Turn the timing of a span into one within jerk limits, on the same geometric path.

    The path speed is smoothed by a moving average over time, which bounds the jerk of a change of
    acceleration by its step over the window. Where the result still exceeds a limit, the path is
    timed again with the motion slowed there and within the window about it, until nothing is
    exceeded by much; the rest is taken from the whole. Of several windows, the best is kept. The
    result is not the optimum: the benchmark tells the distance.

    Args:
        path: The path, with continuous curvature on the span.
        span: Its timing without jerk limits.
        profile: Joint limits on every piece of the path.
        jerk: Jerk limits, shape (dof,).
        constraints: Limits other than those of single joints.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.
    """
    measure = _Measure(path, profile, jerk)
    best = _best_window(span.problem, span.x, measure, check)
    for share in _SOFTNESS:
        # What a swing of the whole duration could build up of acceleration, and less.
        reached = 0.25 * share * jerk * best.time[-1]
        weaker = replace(
            profile,
            acceleration=np.minimum(profile.acceleration, reached),
            acceleration_lower=np.maximum(profile.acceleration_lower, -reached),
        )
        if np.array_equal(weaker.acceleration, profile.acceleration):
            continue
        soft = SpanProblem.build(path, span.problem.grid, weaker, constraints)
        try:
            x = soft.solve(CompiledEngine())
        except EngineFailed:
            continue
        motion = _best_window(soft, x / max(soft.slowdown(x), 1e-300), measure, check)
        best = min(best, motion, key=lambda m: float(m.time[-1]))
    best = best.divided(times_of(best.time, best.s, best.v, best.a, path.s_knots))
    top = measure(best, _FINE_POINTS, best.s[[0, -1]])
    best = best.slowed(float(top[0]) * (1.0 + _MARGIN))
    return _within_constraints(path, best, constraints)


@dataclass(frozen=True, eq=False)
class _Measure:
    """By what factor of time a motion would keep the limits of its joints, place by place."""

    path: JointPath
    profile: LimitProfile
    jerk: Array

    def __call__(self, motion: CubicMotion, points: int, places: Array) -> Array:
        path, profile = self.path, self.profile
        return cubic_demand(
            path.s_knots,
            path.q_knots,
            path.tangents_start,
            path.tangents_end,
            path.third_derivatives(),
            motion.time,
            motion.s,
            motion.v,
            motion.a,
            profile.velocity,
            profile.velocity_lower,
            profile.acceleration,
            profile.acceleration_lower,
            self.jerk,
            points,
            places,
        )


def _best_window(problem: SpanProblem, x: Array, measure: _Measure, check: Check) -> CubicMotion:
    """Return the shortest motion found with any window."""
    duration = float(problem.times(x).sum())
    profile = problem.profile
    limit = np.minimum(profile.acceleration, -profile.acceleration_lower)
    build_up = float((limit / measure.jerk).max())
    windows = dict.fromkeys(min(multiple * build_up, duration) for multiple in _WINDOWS)
    if duration < 2.0 * max(windows):
        windows[duration] = None
    tried = [_smoothed(problem, x, window, measure, check) for window in windows]
    return min(tried, key=lambda motion: float(motion.time[-1]))


def _smoothed(
    problem: SpanProblem, x_free: Array, window: float, measure: _Measure, check: Check
) -> CubicMotion:
    """Return the shortest motion found with one window."""
    s, rows = problem.grid.s, problem.rows()
    slower = np.ones(len(problem.h))
    x, best = x_free, None
    for _ in range(min(max(_EFFORT // len(slower), 6), _ROUNDS)):
        check()
        time = np.concatenate([[0.0], np.cumsum(problem.times(x))])
        motion = CubicMotion(*moving_average(time, s, np.sqrt(x), window))
        demand = measure(motion, _POINTS, s)
        if problem.constraints:
            demand = np.maximum(demand, _constraint_demand(problem, motion))
        top = float(demand.max())
        if best is None or top * motion.time[-1] < best.time[-1]:
            best = motion.slowed(top)
        if top <= _ENOUGH:
            break
        slower *= np.maximum(spread(demand, time, 0.5 * window), 1.0) ** _STEP
        try:
            x = _slower(rows, slower, x_free)
        except EngineFailed:
            break
    assert best is not None  # the first round has made one
    return best


def _constraint_demand(problem: SpanProblem, motion: CubicMotion) -> Array:
    """Return by what factor of time a motion would keep the constraints, shape (n,)."""
    places = problem.grid.s[:-1] + np.array(problem.shares)[:, None] * problem.h
    times = times_of(motion.time, motion.s, motion.v, motion.a, places.ravel())
    _, v, a = motion.at(times)
    return problem.asked(a.reshape(places.shape), np.square(v).reshape(places.shape))


def _slower(rows: StageRows, slower: Array, x_free: Array) -> Array:
    """Return the path speed with every interval passed slower by its own factor."""
    square = np.square(slower)
    at_nodes = np.maximum(np.append(square, square[-1]), np.append(square[0], square))
    tight = square[:, None]
    capped = np.minimum(rows.x_max, x_free / at_nodes)
    scaled, unit = natural_units(StageRows(rows.s, rows.a * tight, rows.b * tight, capped))
    return CompiledEngine().solve(scaled) * unit


def _within_constraints(
    path: JointPath, motion: CubicMotion, constraints: Sequence[PathConstraint]
) -> CubicMotion:
    """Slow a motion by what it exceeds limits other than those of single joints."""
    share = np.array(FINE)
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
