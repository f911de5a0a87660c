"""Full turns: a joint with room for one can meet a target at several values, 2 pi apart.

Where limits bind, going to the nearest copy at every waypoint leads into a limit that costs a
turn back later. The copies of all joints together are too many for a ladder: here only those are
looked at that can still lead to a path shorter than one known.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.copying import copy_into
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.chain import Chain
from ikplan.planning.ladder.motion_cost import MotionCost, posture_distance
from ikplan.sorting import stable_order

__all__ = [
    "equivalents_of",
    "joints_with_full_turn",
    "nearest_equivalent",
    "shortest_over_equivalents",
    "with_equivalents",
]


_TURN = 2.0 * math.pi
_MAX_EQUIVALENTS = 1024
"""Of one solution; further joints go to the copy nearest to where they are."""


@kernel
def joints_with_full_turn(chain: Chain, lower: Array, upper: Array) -> Flags:
    """Return which joints can stand a full turn further and be where they were, shape (dof,)."""
    turns = np.zeros(lower.shape[0], dtype=np.bool_)
    if not chain.coupled:
        for d in range(lower.shape[0]):
            turns[d] = not chain.prismatic[d] and upper[d] - lower[d] >= _TURN
    return turns


@kernel
def nearest_equivalent(value: float, near: float, lower: float, upper: float) -> float:
    """Return the 2 pi copy of a value that is nearest to another within the limits."""
    copy = value - _TURN * math.floor((value - near) / _TURN + 0.5)
    if copy > upper:
        copy -= _TURN
    elif copy < lower:
        copy += _TURN
    return copy if lower <= copy <= upper else value


@kernel
def equivalents_of(q: Array, turns: Flags, lower: Array, upper: Array) -> Array:
    """Return a solution with all its copies within the limits, shape (m, dof) [rad or m].

    The copies of a joint without limits are the ones nearest to the solution.
    """
    dof = q.shape[0]
    first, number = np.empty(dof), np.ones(dof, dtype=np.int64)
    total = _count_equivalents(q, turns, lower, upper, first, number)
    rows = np.empty((total, dof))
    for i in range(total):
        rest = i
        for d in range(dof):
            rows[i, d] = first[d] + _TURN * (rest % number[d])
            rest //= number[d]
    return rows


def with_equivalents(arm: Arm, rows: Array) -> Array:
    """Return solutions, shape (m, dof), with all their copies within the limits, shape (c, dof)."""
    lower, upper = np.array(arm.lower), np.array(arm.upper)  # one compiled kind of arrays
    turns = joints_with_full_turn(arm.chain, lower, upper)
    copies = [equivalents_of(q, turns, lower, upper) for q in np.array(rows)]
    return np.concatenate(copies) if copies else rows


@kernel
def _count_equivalents(
    q: Array,
    turns: Flags,
    lower: Array,
    upper: Array,
    first: Array,
    number: Indices,
) -> int:
    """Write each joint's lowest copy and how many there are; return how many there are in all."""
    total = 1
    for d in range(q.shape[0]):
        first[d], number[d] = q[d], 1
        if not turns[d] or not math.isfinite(upper[d] - lower[d]):
            continue
        lowest = q[d] - _TURN * math.floor((q[d] - lower[d]) / _TURN)
        copies = 1 + math.floor((upper[d] - lowest) / _TURN)
        if total * copies <= _MAX_EQUIVALENTS:
            first[d], number[d] = lowest, copies
            total *= copies
    return total


@kernel
def shortest_over_equivalents(
    q: Array,
    counts: Indices,
    to_go: Array,
    q_start: Array,
    start_free: bool,
    turns: Flags,
    lower: Array,
    upper: Array,
    cost_of: MotionCost,
    known: Array,
    known_length: float,
) -> Array:
    """Return the shortest path through one copy of one solution of each waypoint.

    Args:
        q: Solutions of each waypoint, shape (n, cap, dof) [rad or m].
        counts: How many each waypoint has, shape (n,).
        to_go: Lower bound of the cost from each to the end, shape (n, cap) [rad or m].
        q_start: The start, shape (dof,) [rad or m].
        start_free: Whether the motion may begin anywhere.
        turns: Joints with copies, shape (dof,).
        lower: Lower position limits, shape (dof,) [rad or m].
        upper: Upper position limits, shape (dof,) [rad or m].
        cost_of: What a path costs.
        known: A path, shape (n, dof): returned where there is none shorter.
        known_length: Its cost [rad or m].

    Returns:
        The path, shape (n, dof) [rad or m].
    """
    n, cap, dof = q.shape
    weights, pull, here_q = cost_of.weights, cost_of.pull / n, np.empty(dof)
    first, number = np.empty((cap, dof)), np.ones((cap, dof), dtype=np.int64)
    choice, key, part = np.empty(dof, np.int64), np.zeros(dof + 1, np.int64), np.zeros(dof + 1)
    kept_q, kept_parent = np.empty((64, dof)), np.empty(64, dtype=np.int64)
    begin = np.zeros(n + 1, dtype=np.int64)
    cost_before, q_before = np.zeros(1), q_start.copy().reshape(1, dof)
    for k in range(n):
        most = 1
        for j in range(counts[k]):
            most = max(most, _count_equivalents(q[k, j], turns, lower, upper, first[j], number[j]))
        cost = np.full((counts[k], most), np.inf)
        parent = np.zeros((counts[k], most), dtype=np.int64)
        for i in stable_order(cost_before):
            for j in range(counts[k]):
                room = known_length - to_go[k, j] - cost_before[i]
                if k == 0 and start_free:
                    room = np.inf
                if room < 0.0:
                    continue
                # Depth first over the joints; a branch ends where the step is longer than may be.
                d = 0
                choice[0] = -1
                while d >= 0:
                    choice[d] += 1
                    if choice[d] >= number[j, d]:
                        d -= 1
                        continue
                    value = first[j, d] + _TURN * choice[d]
                    if turns[d] and number[j, d] == 1:
                        value = nearest_equivalent(value, q_before[i, d], lower[d], upper[d])
                    part[d + 1] = part[d] + (weights[d] * (value - q_before[i, d])) ** 2
                    if part[d + 1] > room * room:
                        continue
                    here_q[d] = value
                    key[d + 1] = key[d] * number[j, d] + choice[d]
                    if d + 1 < dof:
                        d += 1
                        choice[d] = -1
                        continue
                    total = cost_before[i]
                    if k > 0 or not start_free:
                        total += math.sqrt(part[dof])
                    if pull > 0.0:
                        total += pull * posture_distance(here_q, cost_of)
                    if total < cost[j, key[dof]]:
                        cost[j, key[dof]] = total
                        parent[j, key[dof]] = i
        alive = 0
        for j in range(counts[k]):
            for c in range(most):
                alive += cost[j, c] + to_go[k, j] <= known_length
        if alive == 0:
            return known
        here, q_here = np.empty(alive), np.empty((alive, dof))
        begin[k + 1] = begin[k] + alive
        while begin[k + 1] > kept_q.shape[0]:
            kept_q = np.concatenate((kept_q, np.empty_like(kept_q)))
            kept_parent = np.concatenate((kept_parent, np.empty_like(kept_parent)))
        at = 0
        for j in range(counts[k]):
            for c in range(most):
                if not cost[j, c] + to_go[k, j] <= known_length:
                    continue
                rest, source = c, parent[j, c]
                for back in range(dof):
                    d = dof - 1 - back
                    value = first[j, d] + _TURN * (rest % number[j, d])
                    rest //= number[j, d]
                    if turns[d] and number[j, d] == 1:
                        value = nearest_equivalent(value, q_before[source, d], lower[d], upper[d])
                    q_here[at, d] = value
                here[at] = cost[j, c]
                copy_into(kept_q[begin[k] + at], q_here[at])
                kept_parent[begin[k] + at] = source
                at += 1
        cost_before, q_before = here, q_here
    path = np.empty((n, dof))
    i = np.argmin(cost_before)
    for back in range(n):
        k = n - 1 - back
        copy_into(path[k], kept_q[begin[k] + i])
        i = kept_parent[begin[k] + i]
    return path
