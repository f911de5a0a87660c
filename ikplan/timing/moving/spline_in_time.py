"""Joint paths whose parameter is the time: through waypoints at given times."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.joint_path.joint_path import JointPath
from ikplan.joint_path.spline import limit_tangents
from ikplan.limits.joint_limits import JointLimits
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.grid import Grid
from ikplan.timing.moving.moving_ends import MovingEnds
from ikplan.timing.moving.moving_path import with_bends
from ikplan.timing.problem import SpanProblem
from ikplan.timing.profile import LimitProfile, SegmentJointLimits
from ikplan.timing.span import SpanTiming
from ikplan.timing.timed_path import TimedPath

__all__ = ["motion_in_time", "slowdown_in_time", "spline_in_time"]


def spline_in_time(
    times: Array,
    q: Array,
    limits: JointLimits,
    rest_at: Sequence[int],
    ends: MovingEnds | None,
) -> JointPath | None:
    """Lay a spline over time through waypoints.

    The second derivative is continuous but at waypoints of rest; under jerk limits it is zero at
    these and at the end, and at the start as asked for.

    Args:
        times: Times of the waypoints, shape (n,), n >= 2, strictly increasing from 0 [s].
        q: The waypoints, shape (n, dof) [rad or m].
        limits: Joint limits.
        rest_at: Waypoints where the motion rests.
        ends: Joint rates at the ends; None: rest.

    Returns:
        The path, its parameter the time; None: it cannot stay inside the position limits, or under
        jerk limits not without a jump of the acceleration.
    """
    from scipy.interpolate import CubicSpline

    zero = np.zeros(q.shape[1])
    start_velocity, pull, end_velocity = (
        (zero, zero, zero)
        if ends is None
        else (ends.start_velocity, ends.start_acceleration, ends.end_velocity)
    )
    last = len(q) - 1
    jerk = limits.jerk is not None
    parts, knot_of, count = [], np.zeros(len(q), dtype=np.int64), 0
    rests = [0]
    for a, b in itertools.pairwise(sorted({0, last, *rest_at})):
        v0, v1 = (start_velocity if a == 0 else zero), (end_velocity if b == last else zero)
        t, rows = times[a : b + 1], q[a : b + 1]
        m = np.ascontiguousarray(CubicSpline(t, rows, bc_type=((1, v0), (1, v1)))(t, 1))
        m[0], m[-1] = v0, v1
        changed = limit_tangents(t, rows, m, limits.lower, limits.upper)
        if not (np.array_equal(m[0], v0) and np.array_equal(m[-1], v1)) or (changed and jerk):
            return None
        laid = (t, rows, m[:-1].copy(), m[1:].copy())
        knots = np.arange(len(t))
        if jerk:
            laid = with_bends(laid, pull if a == 0 else zero, zero)
            knots = np.searchsorted(laid[0], t)
        knot_of[a : b + 1] = count + knots
        count += len(laid[0]) - 1
        rests.append(count)
        parts.append(laid)
    return JointPath(
        np.concatenate([parts[0][0][:1], *(part[0][1:] for part in parts)]),
        np.vstack([parts[0][1][:1], *(part[1][1:] for part in parts)]),
        np.ascontiguousarray(np.vstack([part[2] for part in parts])),
        np.ascontiguousarray(np.vstack([part[3] for part in parts])),
        rest_knots=rests,
        knot_of_waypoint=knot_of,
    )


def motion_in_time(
    path: JointPath,
    limits: JointLimits,
    segments: Sequence[SegmentJointLimits],
    constraints: Sequence[PathConstraint],
) -> TimedPath:
    """Return the motion along a path whose parameter is the time.

    Args:
        path: The path.
        limits: Joint limits of the whole path.
        segments: Joint limits of ranges of it.
        constraints: Limits other than those of single joints.
    """
    ranges = [(r.start, r.end) for r in segments] + [(r.start, r.end) for r in constraints]
    path = path.with_knots([place for both in ranges for place in both])
    profile = LimitProfile.merged(path, limits, segments)
    n = len(path.s_knots) - 1
    grid = Grid(path.s_knots, np.arange(n))
    problem = SpanProblem.build(path, grid, profile, constraints)
    ones = np.ones(n + 1)
    span = SpanTiming(problem, ones, np.diff(path.s_knots), 0.0, "given times")
    jerk = any(x.jerk is not None for x in (limits, *(s.limits for s in segments)))
    return TimedPath(
        path=path,
        s=path.s_knots,
        pieces=np.zeros(0, dtype=np.int64) if jerk else np.arange(n),
        sdot=ones,
        node_times=path.s_knots,
        spans=(span,),
        sddot=np.zeros(n + 1) if jerk else None,
    )


def slowdown_in_time(timed: TimedPath) -> float:
    """Return by what factor of time a motion in time would keep its limits."""
    problem = timed.spans[0].problem
    factor = float(np.sqrt(problem.interval_ratios(timed.spans[0].x).max()))
    if timed.jerk_limited:
        third = np.abs(timed.path.third_derivatives)
        factor = max(factor, float(np.cbrt((third / problem.profile.jerk).max())))
    return factor
