"""The last look at a jerk-limited motion of a span: slowed by what it exceeds any limit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint, PathPoints
from ikplan.timing.constraints.interval_points import FINE, highest
from ikplan.timing.jerk.cubic_kernels import times_of
from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.smoothing import JointSlowdown
from ikplan.timing.problem import SpanProblem

__all__ = ["MARGIN", "ROUNDING", "constraint_factors", "within_limits"]

_FINE_POINTS = 24
_INSIDE = 1e-7
# Kept below the limits: they are measured at points of intervals, not between them.
MARGIN = 2e-4
# The same for a closed form, so that rounding in a sample cannot step over a limit.
ROUNDING = 2e-9


def within_limits(
    problem: SpanProblem, motion: CubicMotion, slowdown: JointSlowdown, margin: float = MARGIN
) -> CubicMotion:
    """Slow a motion by what it exceeds its limits, looked at in finer steps.

    Args:
        problem: The span and its limits.
        motion: The motion.
        slowdown: What judges it by the limits of the joints.
        margin: What to stay below those.

    Returns:
        The motion, within every limit.
    """
    path = problem.path
    first, last = np.searchsorted(path.s_knots, motion.s[[0, -1]])
    knots = path.s_knots[first : last + 1].copy()  # one compiled kind of arrays
    motion = motion.divided(times_of(motion.time, motion.s, motion.v, motion.a, knots))
    factor = slowdown(motion, _FINE_POINTS, motion.s[[0, -1]])
    motion = motion.slowed(float(factor[0]) * (1.0 + margin))
    if not problem.constraints:
        return motion
    factors = constraint_factors(path, motion, problem.constraints)
    return motion.slowed(max(float(factors.max()), 1.0))


def constraint_factors(
    path: JointPath, motion: CubicMotion, constraints: Sequence[PathConstraint]
) -> Array:
    """Return by what factor of time a motion would keep limits other than those of single joints.

    Args:
        path: The path.
        motion: The motion.
        constraints: The limits; looked at in five points of every interval.

    Returns:
        Factors, with what may be between the points, shape (n,); 0 where there is no limit.
    """
    # The ends from inside: at a knot the curvature may step.
    share = np.clip(FINE, _INSIDE, 1.0 - _INSIDE)
    dt = np.diff(motion.time)
    j = np.divide(np.diff(motion.a), dt, out=np.zeros(len(dt)), where=dt > 0.0)
    r = share[:, None] * dt
    s0, v0, a0 = motion.s[:-1], motion.v[:-1], motion.a[:-1]
    s = s0 + r * (v0 + r * (0.5 * a0 + r * j / 6.0))
    x = np.square(v0 + r * (a0 + 0.5 * r * j))
    u = a0 + r * j
    largest = np.zeros(len(dt))
    for constraint in constraints:
        inside = np.flatnonzero((s[2] > constraint.start) & (s[2] < constraint.end))
        if len(inside):
            at = s[:, inside].ravel()
            points = PathPoints(at, *path.derivatives(at), path.length)
            index = np.arange(len(at))
            ratios = constraint.at(points).ratios(index, u[:, inside].ravel(), x[:, inside].ravel())
            most = highest(ratios.reshape(len(FINE), len(inside), -1)).max(axis=1)
            largest[inside] = np.maximum(largest[inside], most * (1.0 + MARGIN))
    return np.sqrt(np.maximum(largest, 0.0))
