"""Jerk-limited timing: a motion played along its own course as fast as the limits allow."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathPoints
from ikplan.timing.engines.engine import Check
from ikplan.timing.jerk.barrier_lanes import WarpLimits
from ikplan.timing.jerk.course_kernels import apart, course_rates, spline_basis
from ikplan.timing.jerk.cubic_kernels import times_of
from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.smoothing import JointSlowdown
from ikplan.timing.jerk.through_nodes import slow_nodes, through_nodes
from ikplan.timing.jerk.warp_kernels import fastest_warp
from ikplan.timing.jerk.within_limits import constraint_factors
from ikplan.timing.problem import SpanProblem

__all__ = ["fastest"]

# Intervals of a motion: at least so many, so many a piece of the path, and at most so many.
_LEAST, _A_PIECE, _MOST = 64, 8, 6_000
# As many as without jerk limits, where the motion takes so many times as long as accelerations
# take to build up; where it takes less, fewer in proportion.
_SLOW = 50.0
_OF_SPARSE = 300  # taken for their number where the grid without jerk limits is sparse
# And at least so many for each time in which accelerations build up, up to a number.
_A_SWING, _MOST_BY_SWINGS = 2.0, 1_000
# Intervals shorter than this share of the mean one are joined with their neighbours.
_SHORT = 0.02
# When what is exceeded between the points that are looked at is little enough.
_ENOUGH, _POINTS = 1.002, 6
# The same under limits of the tool, whose speed shall hardly vary.
_ENOUGH_OF_OTHERS = 1.0007
# Factors of the number of intervals tried, where fewer give no motion.
_FINER = (1.0, 2.0, 4.0)
# Weights of the barrier, an interval, as shares of the duration: the first one for a motion that
# exceeds limits by much, and for another; the last one, which is about what is lost by it, on a
# grid that will be laid anew and on the last one.
_FIRST_MU, _AGAIN_MU, _ROUGH_MU, _LAST_MU, _SHRINK = 0.1, 3e-3, 1e-3, 5e-5, 0.1
_GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])
_GAUSS_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0


def fastest(
    problem: SpanProblem,
    motion: CubicMotion,
    build_up: float,
    slowdown: JointSlowdown,
    check: Check,
    rounds: tuple[int, int] = (2, 4),
    led: bool = False,
) -> CubicMotion:
    """Shorten a motion within its limits, to a local optimum on a grid.

    The motion is played at a speed that varies along it: the squared rate is a quadratic spline
    over time, found by an interior-point method (see fastest_warp). The result is played again,
    on a grid that is finer where the jerk changes.

    Args:
        problem: The path and its limits.
        motion: A motion along it, from rest to rest, not at rest between.
        build_up: About the time in which the jerk limits build up the acceleration limits [s].
        slowdown: The limits of the joints.
        check: Is called before each round, and may end the search by an error of its own.
        rounds: How often a grid is laid, at least once, and how often the motion is played at
            most on the last one, limits tightened by what is exceeded between the points that
            are looked at. A motion that is nearly optimal needs less.
        led: See fastest_warp.

    Returns:
        The motion, which may exceed limits by a little.
    """
    path = problem.path
    # The faster accelerations change, the more the motion is like that without jerk limits.
    swings = float(motion.time[-1]) / build_up
    least = max(_LEAST, min(_A_SWING * swings, _MOST_BY_SWINGS))
    intervals = max(len(problem.h), _OF_SPARSE) if problem.sparse else len(problem.h)
    count = min(max(least, min(swings / _SLOW, 1.0) * intervals), _MOST)
    best, shortest = motion, np.inf
    regrids, tightenings = rounds
    for k in range(regrids):
        last = k == regrids - 1
        course = _course(path, motion, count, even=not last)
        if course is None:
            return best
        tight = np.ones(len(course.s) - 1)
        for _ in range(tightenings):
            check()
            weight = _LAST_MU if last else _ROUGH_MU
            played = _played(problem, course, slowdown, tight, weight, build_up, led)
            if played is None:
                return best
            course = motion = played
            if not last:
                best = played
                break
            excess = slowdown(played, _POINTS, played.s)
            if problem.constraints:
                others = constraint_factors(path, played, problem.constraints)
                excess = np.maximum(excess, others)
            top = float(excess.max())
            if top * played.time[-1] < shortest:
                best, shortest = played, top * float(played.time[-1])
            if top <= (_ENOUGH_OF_OTHERS if problem.constraints else _ENOUGH):
                break
            tight *= np.maximum(excess, 1.0)
    return best


def _course(
    path: JointPath, motion: CubicMotion, count: float, *, even: bool
) -> CubicMotion | None:
    """Return a motion on a new grid, a finer one if need be; None: on none that was tried."""
    for factor in _FINER:
        times = _grid(path, motion, factor * count, even=even)
        s, v, a = motion.at(times)
        s[0], s[-1] = motion.s[0], motion.s[-1]
        course = through(times, s, v, a)
        if course is not None:
            return course
    return None


def _grid(path: JointPath, motion: CubicMotion, count: float, *, even: bool) -> Array:
    """Return times, those at knots of the path among them; not even: more where jerks change."""
    end = float(motion.time[-1])
    first = np.searchsorted(path.s_knots, motion.s[0], "right")
    inner = path.s_knots[first : np.searchsorted(path.s_knots, motion.s[-1])].copy()
    knots = times_of(motion.time, motion.s, motion.v, motion.a, inner)
    count = max(count, min(_A_PIECE * (len(knots) + 1), _MOST))
    shortest = _SHORT * end / count
    knots = apart(np.concatenate([[0.0], knots, [end]]), shortest)
    dt = np.diff(motion.time)
    mass = 0.5 * dt / end + 0.5 / len(dt)
    if not even:
        jump = np.abs(np.diff(np.diff(motion.a) / dt))
        share = np.append(jump, 0.0) + np.append(0.0, jump)
        mass = 0.6 * mass + 0.4 * share / max(float(share.sum()), 1e-300)
    level = np.append(0.0, np.cumsum(mass))
    at = np.interp(knots, motion.time, level)
    parts = np.maximum(np.rint(np.diff(at) * count), 1.0).astype(np.int64)
    piece = np.repeat(np.arange(len(parts)), parts)
    first = np.cumsum(parts) - parts
    share = (np.arange(len(piece)) - first[piece]) / parts[piece]
    times = np.interp(at[piece] + share * np.diff(at)[piece], level, motion.time)
    room = np.minimum(times - knots[piece], knots[piece + 1] - times)
    times[first], room[first] = knots[:-1], np.inf
    return apart(np.append(times[room > shortest], end), shortest)


def through(time: Array, s: Array, v: Array, a: Array) -> CubicMotion | None:
    """Return the motion with given places and accelerations at nodes, nearly at given times.

    Args:
        time: Times of the nodes [s], shape (n + 1,), from 0.
        s: Path positions there, shape (n + 1,), strictly increasing.
        v: Path velocities there, nearly, shape (n + 1,).
        a: Path accelerations there, shape (n + 1,).

    Returns:
        The motion, from rest to rest; accelerations are changed a little, so that it ends at rest
        (see through_nodes). None: there is none.
    """
    motion = CubicMotion(*through_nodes(time, s, v, a, slow_nodes(v)))
    return motion if np.isfinite(motion.time[-1]) else None


def _played(
    problem: SpanProblem,
    course: CubicMotion,
    slowdown: JointSlowdown,
    tight: Array,
    last_mu: float,
    build_up: float,
    led: bool,
) -> CubicMotion | None:
    """Return a motion played as fast as its limits allow; None: none was found."""
    path, profile = slowdown.path, slowdown.profile
    n, end = len(course.time) - 1, float(course.time[-1])
    rates, most, up, down, points = course_rates(
        path.s_knots,
        path.q_knots,
        path.tangents_start,
        path.tangents_end,
        slowdown.third,
        course.time,
        course.s,
        course.v,
        course.a,
        profile.velocity,
        profile.velocity_lower,
        profile.acceleration,
        profile.acceleration_lower,
        profile.jerk,
    )
    rows_b, rows_d, bound = _rows(problem, points)
    square = np.square(tight)
    rates[:, :, 2:] *= square * tight
    limits = WarpLimits(
        rates,
        np.minimum(most, bound) / square,
        up * square,
        down * square,
        rows_b * square,
        rows_d * square / end,
    )
    tau = course.time / end
    weights = _FIRST_MU / n, _AGAIN_MU / n, last_mu / n
    c = fastest_warp(tau, limits, weights, _SHRINK, build_up / end, led)
    if not c.any():
        return None
    value, _, _ = spline_basis(tau, _GAUSS)
    index = np.arange(n)[:, None] + np.arange(3)
    inside = np.einsum("ikx,ix->ik", value, c[index])
    if not (inside > 0.0).all():
        return None
    dt = np.diff(course.time) * (_GAUSS_WEIGHTS / np.sqrt(inside)).sum(axis=1)
    value, slope, _ = spline_basis(tau, np.array([0.0, 1.0]))
    b = np.einsum("ikx,ix->ik", value, c[index])
    b1 = np.einsum("ikx,ix->ik", slope, c[index]) / end
    b, b1 = np.append(b[:, 0], b[-1, 1]), np.append(b1[:, 0], b1[-1, 1])
    a = course.a * b + 0.5 * course.v * b1
    return through(
        np.append(0.0, np.cumsum(dt)), course.s, course.v * np.sqrt(np.maximum(b, 0.0)), a
    )


def _rows(problem: SpanProblem, points: Array) -> tuple[Array, Array, Array]:
    """Return limits other than those of single joints as rows p b + d b' <= 1, and bounds of b.

    Args:
        problem: The path and its limits.
        points: Path positions, velocities and accelerations, shape (n, 2, 3).

    Returns:
        p, d and the bounds as in WarpLimits, shapes (2, rows, n), (2, rows, n) and (2, n).
    """
    n = len(points)
    s, v, a = points.reshape(-1, 3).T
    bound = np.full(2 * n, np.inf)
    found = []
    used = np.zeros(2 * n, dtype=np.int64)
    for constraint in problem.constraints:
        inside = np.flatnonzero((s > constraint.start) & (s < constraint.end))
        if not len(inside):
            continue
        at = s[inside]
        rows = constraint.at(PathPoints(at, *problem.path.derivatives(at), problem.path.length))
        np.divide(rows.x_max, np.square(v[inside]), out=rows.x_max, where=v[inside] > 0.0)
        bound[inside] = np.minimum(bound[inside], rows.x_max)
        if rows.columns:
            of_u, of_x = rows.coefficients(np.arange(len(inside)))
            first = int(used[inside].max())
            used[inside] = first + rows.columns
            found.append((inside, first, of_u, of_x))
    rows_b, rows_d = np.zeros((2, 2 * n, int(used.max(initial=0))))
    for inside, first, of_u, of_x in found:
        place = slice(first, first + of_u.shape[1])
        rows_b[inside, place] = of_u * a[inside, None] + of_x * np.square(v[inside])[:, None]
        rows_d[inside, place] = 0.5 * of_u * v[inside, None]
    rows = rows_b.shape[1]
    rows_b, rows_d = (x.reshape(n, 2, rows).transpose(1, 2, 0) for x in (rows_b, rows_d))
    most = np.ascontiguousarray(bound.reshape(n, 2).T)
    return np.ascontiguousarray(rows_b), np.ascontiguousarray(rows_d), most
