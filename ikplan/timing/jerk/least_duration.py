"""What a jerk-limited motion of a span takes at least."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.timing.jerk.double_s import double_s_duration
from ikplan.timing.problem import SpanProblem

__all__ = ["least_duration"]

# What the grid may cost a motion without jerk limits, as a share of its duration, and how much
# faster than it another one may be anywhere.
_LOSS, _FASTER = 5e-3, 1.01
# Joints that move less than this share of the one that moves most are at rest.
_STILL = 1e-9


def least_duration(problem: SpanProblem, x: Array) -> tuple[float, float]:
    """Return lower bounds of the duration of a jerk-limited motion from rest to rest.

    The first is that of single joints: each takes at least as long for the distance between its
    positions at both ends as by the double-S profile. No motion is anywhere faster on its path
    than the shortest one without jerk limits (Pham and Pham, IEEE T-RO 2018, section III), which
    bounds the joint's velocity beside its own limit. The second is the duration of the latter.

    Args:
        problem: The span and its limits; limits that vary count where they are widest.
        x: Squared path velocities at the nodes of the shortest motion without jerk limits, shape
            (n + 1,).

    Returns:
        Both bounds [s].
    """
    path, profile, pieces = problem.path, problem.profile, problem.grid.pieces
    first, last = int(pieces[0]), int(pieces[-1]) + 1
    ways = path.q_knots[last] - path.q_knots[first]
    sdot = np.sqrt(x)
    end = problem.qs0 + 0.5 * problem.h[:, None] * (problem.qss0 + problem.qss1)
    fastest = np.maximum(
        (np.abs(problem.qs0) * sdot[:-1, None]).max(axis=0),
        (np.abs(end) * sdot[1:, None]).max(axis=0),
    )
    span = slice(first, last)
    up, down = profile.velocity[span].max(axis=0), -profile.velocity_lower[span].min(axis=0)
    a_up = profile.acceleration[span].max(axis=0)
    a_down = -profile.acceleration_lower[span].min(axis=0)
    jerk = profile.jerk[span].max(axis=0)
    ahead = ways > 0.0
    velocity = np.minimum(np.where(ahead, up, down), _FASTER * fastest)
    faster, slower = np.where(ahead, a_up, a_down), np.where(ahead, a_down, a_up)
    moves = np.abs(ways) > _STILL * np.abs(ways).max()
    by_jerk = 0.0
    for j in np.flatnonzero(moves & np.isfinite(jerk)).tolist():
        by_jerk = max(
            by_jerk,
            double_s_duration(
                abs(float(ways[j])),
                float(velocity[j]),
                float(faster[j]),
                float(slower[j]),
                float(jerk[j]),
            ),
        )
    return by_jerk, (1.0 - _LOSS) * float(problem.times(x).sum())
