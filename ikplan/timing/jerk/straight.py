"""The shortest jerk-limited motion along a straight line of the joint space."""

from __future__ import annotations

import numpy as np

from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.double_s import double_s
from ikplan.timing.problem import SpanProblem

__all__ = ["straight_motion"]

# How far tangents may be from one direction, as a share of the greatest; rounding is below it.
_STRAIGHT = 1e-9
# Joints that move less than this share of the one that moves most are at rest.
_STILL = 1e-12


def straight_motion(problem: SpanProblem) -> CubicMotion | None:
    """Return the shortest motion from rest to rest where the joints move in proportion.

    The limits of every joint, over its share of the path, are limits of the path speed; the
    strictest of each kind make a double-S profile.

    Args:
        problem: The span and its limits; only those of joints are looked at.

    Returns:
        The motion; None: the span bends, its limits vary, or no jerk is limited.
    """
    path, profile = problem.path, problem.profile
    pieces = np.unique(problem.grid.pieces)
    first, last = int(pieces[0]), int(pieces[-1]) + 1
    s = path.s_knots[first : last + 1]
    chord = np.diff(path.q_knots[first : last + 1], axis=0) / np.diff(s)[:, None]
    d = path.tangents_start[first]
    most = float(np.abs(d).max())
    bends = [path.tangents_start[first:last], path.tangents_end[first:last], chord]
    if max(float(np.abs(row - d).max()) for row in bends) > _STRAIGHT * most:
        return None
    limits = [
        profile.velocity,
        profile.velocity_lower,
        profile.acceleration,
        profile.acceleration_lower,
        profile.jerk,
    ]
    if any((limit[first:last] != limit[first]).any() for limit in limits):
        return None
    moving = np.abs(d) > _STILL * most
    up, down, a_up, a_down, jerk = (limit[first][moving] for limit in limits)
    d = d[moving]
    slowest = float((jerk / np.abs(d)).min())
    if not np.isfinite(slowest):
        return None
    ahead = d > 0.0
    motion = double_s(
        float(s[-1] - s[0]),
        float((np.where(ahead, up, down) / d).min()),
        float((np.where(ahead, a_up, a_down) / d).min()),
        float((np.where(ahead, -a_down, -a_up) / d).min()),
        slowest,
    )
    places = np.minimum(s[0] + motion.s, s[-1])
    places[-1] = s[-1]
    return CubicMotion(motion.time, places, motion.v, motion.a)
