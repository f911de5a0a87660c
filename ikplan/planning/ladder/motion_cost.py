"""What a sequence of configurations costs: its joint motion, and how far it is from a posture."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags

__all__ = [
    "MotionCost",
    "motion_cost_along",
    "plain_cost",
    "posture_distance",
    "posture_distances",
    "sequence_cost",
    "turned_posture_distance",
]


_TURN = 2.0 * math.pi


class MotionCost(NamedTuple):
    """What a sequence costs: the sum of its weighted steps, and its mean distance from a posture.

    Attributes:
        weights: How much the motion of each joint counts, shape (dof,).
        lower: Lower end of each joint's preferred range, -inf without one, shape (dof,) [rad or m].
        upper: Upper end of it, inf without one, shape (dof,) [rad or m].
        pull: What the distance from the preferred ranges counts against as much motion, 0 or more.
    """

    weights: Array
    lower: Array
    upper: Array
    pull: float


def plain_cost(dof: int) -> MotionCost:
    """Return the cost of joint motion alone, all joints alike."""
    return MotionCost(np.ones(dof), np.full(dof, -np.inf), np.full(dof, np.inf), 0.0)


def motion_cost_along(s: Array, q: Array, cost: MotionCost) -> float:
    """Return the cost of a motion through points of a path, the posture's by the path's length.

    Args:
        s: Path positions, shape (m,).
        q: Configurations, shape (m, dof) [rad or m].
        cost: What the motion costs.
    """
    if cost.pull <= 0.0:
        return sequence_cost(q, q[0], True, cost)
    length = sequence_cost(q, q[0], True, cost._replace(pull=0.0))
    away = posture_distances(q, cost._replace(pull=1.0))
    if len(s) < 2 or s[-1] <= s[0]:
        return length + cost.pull * float(away.mean())
    return length + cost.pull * float(np.trapezoid(away, s) / (s[-1] - s[0]))


def posture_distances(q: Array, cost: MotionCost) -> Array:
    """Return what the distance of each of configurations, (c, dof), from the posture counts."""
    if cost.pull <= 0.0:
        return np.zeros(len(q))
    return cost.pull * np.array([posture_distance(row, cost) for row in q])


@kernel
def posture_distance(q: Array, cost: MotionCost) -> float:
    """Return the weighted distance of q, shape (dof,), from the preferred ranges."""
    total = 0.0
    for d in range(q.shape[0]):
        outside = max(cost.lower[d] - q[d], q[d] - cost.upper[d], 0.0)
        total += (cost.weights[d] * outside) ** 2
    return math.sqrt(total)


@kernel
def turned_posture_distance(q: Array, turns: Flags, cost: MotionCost) -> float:
    """Return the least that :func:`posture_distance` is over full turns of the turning joints."""
    total = 0.0
    for d in range(q.shape[0]):
        outside = max(cost.lower[d] - q[d], q[d] - cost.upper[d], 0.0)
        if turns[d] and outside > 0.0:
            # The copy next above the range, and the one below that, which may be inside.
            over, width = q[d] - cost.upper[d], cost.upper[d] - cost.lower[d]
            outside = 0.0
            if width < _TURN:
                above = over - _TURN * math.floor(over / _TURN)
                outside = max(min(above, _TURN - above - width), 0.0)
        total += (cost.weights[d] * outside) ** 2
    return math.sqrt(total)


@kernel
def sequence_cost(q: Array, q_start: Array, start_free: bool, cost: MotionCost) -> float:
    """Return the cost of a motion from the start through q, shape (n, dof)."""
    n = q.shape[0]
    total = 0.0
    for k in range(n):
        if k == 0 and start_free:
            continue
        step = 0.0
        for d in range(q.shape[1]):
            before = q_start[d] if k == 0 else q[k - 1, d]
            step += (cost.weights[d] * (q[k, d] - before)) ** 2
        total += math.sqrt(step)
    if cost.pull > 0.0:
        for k in range(n):
            total += cost.pull / n * posture_distance(q[k], cost)
    return total
