"""The least joint motion through one candidate per waypoint: shortest paths over the ladder.

The shortest path over the candidates is not always the one that is shortest once shortened, so
several that really differ are offered.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.copying import copy_into, copy_rows_into
from ikplan.kinematics.chain import Chain
from ikplan.planning.ladder.equivalent_configurations import (
    joints_with_full_turn,
    nearest_equivalent,
    shortest_over_equivalents,
)
from ikplan.planning.ladder.ik_candidates import IkCandidates
from ikplan.planning.ladder.motion_cost import (
    MotionCost,
    posture_distance,
    sequence_cost,
    turned_posture_distance,
)
from ikplan.sorting import stable_order

__all__ = ["diverse_shortest_paths"]

_SURELY_MORE = 1.0 + 1e-12
"""A square above this times another is above it in spite of rounding."""


@leaf_kernel
def _step_to(
    q: Array, q_before: Array, turns: Flags, lower: Array, upper: Array, weights: Array, most: float
) -> float:
    """Return the weighted distance to q, each joint at its copy nearest to where it is.

    Where some of the joints are already farther than ``most``, it is inf.
    """
    total, largest = 0.0, most * most * _SURELY_MORE
    for d in range(q.shape[0]):
        value = nearest_equivalent(q[d], q_before[d], lower[d], upper[d]) if turns[d] else q[d]
        total += (weights[d] * (value - q_before[d])) ** 2
        if total > largest:
            return math.inf
    return math.sqrt(total)


@kernel
def _nearest_equivalent_into(
    q: Array, q_before: Array, turns: Flags, lower: Array, upper: Array, out: Array
) -> None:
    """Write q with each joint at its copy nearest to where it is."""
    for d in range(q.shape[0]):
        out[d] = nearest_equivalent(q[d], q_before[d], lower[d], upper[d]) if turns[d] else q[d]


@kernel
def _cost_to_come(
    candidates: IkCandidates,
    q_start: Array,
    start_free: bool,
    turns: Flags,
    lower: Array,
    upper: Array,
    cost_of: MotionCost,
) -> tuple[Array, Indices, Array]:
    """Least cost from the start to every candidate, and the candidate before it there.

    Turns are chosen as the motion goes: each joint goes to the copy nearest to where the motion has
    brought it.

    Returns:
        Costs, shape (n, cap), inf where there is no candidate; parents, shape (n, cap); and the
        candidates turned as they are reached, shape (n, cap, dof).
    """
    n, cap, _ = candidates.q.shape
    weights, pull = cost_of.weights, cost_of.pull / n
    cost = np.full((n, cap), np.inf)
    parent = np.zeros((n, cap), dtype=np.int64)
    reached = candidates.q.copy()
    for j in range(candidates.counts[0]):
        if start_free:
            cost[0, j] = 0.0
        else:
            cost[0, j] = _step_to(candidates.q[0, j], q_start, turns, lower, upper, weights, np.inf)
            _nearest_equivalent_into(
                candidates.q[0, j], q_start, turns, lower, upper, reached[0, j]
            )
        if pull > 0.0:
            cost[0, j] += pull * posture_distance(reached[0, j], cost_of)
    for k in range(1, n):
        for j in range(candidates.counts[k]):
            q = candidates.q[k, j]
            for i in range(candidates.counts[k - 1]):
                most = cost[k, j] - cost[k - 1, i]
                if most > 0.0:
                    before = reached[k - 1, i]
                    step = _step_to(q, before, turns, lower, upper, weights, most)
                    total = cost[k - 1, i] + step
                    if total < cost[k, j]:
                        cost[k, j] = total
                        parent[k, j] = i
            _nearest_equivalent_into(
                q, reached[k - 1, parent[k, j]], turns, lower, upper, reached[k, j]
            )
            if pull > 0.0:
                cost[k, j] += pull * posture_distance(reached[k, j], cost_of)
    return cost, parent, reached


@kernel
def _cost_to_go(
    candidates: IkCandidates, turns: Flags, cost_of: MotionCost
) -> tuple[Array, Indices]:
    """Least cost from every candidate to the end, and the candidate after it there.

    As if no limit stood in the way of a turn: where the motion will have brought a joint by then
    is not known yet.
    """
    n, cap, _ = candidates.q.shape
    weights, pull = cost_of.weights, cost_of.pull / n
    cost = np.full((n, cap), np.inf)
    own = np.zeros(cap)
    child = np.zeros((n, cap), dtype=np.int64)
    for j in range(candidates.counts[n - 1]):
        cost[n - 1, j] = 0.0
    lower, upper = np.full(turns.shape[0], -np.inf), np.full(turns.shape[0], np.inf)
    for back in range(n - 1):
        k = n - 2 - back
        if pull > 0.0:
            for i in range(candidates.counts[k + 1]):
                own[i] = pull * turned_posture_distance(candidates.q[k + 1, i], turns, cost_of)
        for j in range(candidates.counts[k]):
            q = candidates.q[k, j]
            for i in range(candidates.counts[k + 1]):
                most = cost[k, j] - cost[k + 1, i]
                if most > 0.0:
                    after = candidates.q[k + 1, i]
                    step = _step_to(after, q, turns, lower, upper, weights, most) + own[i]
                    if cost[k + 1, i] + step < cost[k, j]:
                        cost[k, j] = cost[k + 1, i] + step
                        child[k, j] = i
    return cost, child


@kernel
def diverse_shortest_paths(
    chain: Chain,
    candidates: IkCandidates,
    q_start: Array,
    start_free: bool,
    lower: Array,
    upper: Array,
    cost: MotionCost,
    max_paths: int,
    min_separation: float,
    relative_slack: float,
) -> Array:
    """Return the shortest paths over the ladder that really differ, shortest first.

    Every candidate has a shortest path through it; they are taken in order of length, leaving out
    candidates near to a path taken already.

    Args:
        chain: The chain from base to tool.
        candidates: IkCandidates of each waypoint; each waypoint has at least one.
        q_start: The start, shape (dof,) [rad or m].
        start_free: Whether the motion may begin at any candidate of the first waypoint.
        lower: Lower position limits, -inf for a joint without, shape (dof,) [rad or m].
        upper: Upper position limits, inf for a joint without, shape (dof,) [rad or m].
        cost: What a path costs.
        max_paths: Most paths to return.
        min_separation: Paths differ when some joint is this far apart at some waypoint [rad or m].
        relative_slack: Paths longer than (1 + relative_slack) times the shortest are left out.

    Returns:
        Paths, shape (m, n, dof), 1 <= m <= max_paths [rad or m].
    """
    n, cap, dof = candidates.q.shape
    turns = joints_with_full_turn(chain, lower, upper)
    to_come, parent, reached = _cost_to_come(
        candidates, q_start, start_free, turns, lower, upper, cost
    )
    to_go, child = _cost_to_go(candidates, turns, cost)
    through = (to_come + to_go).reshape(n * cap)
    order = stable_order(through)
    paths = np.empty((max_paths, n, dof))
    found = 0
    for at in order:
        if found == max_paths or not through[at] <= (1.0 + relative_slack) * through[order[0]]:
            break
        middle, j = at // cap, at % cap
        if not _is_distinct(paths[:found, middle], reached[middle, j], min_separation):
            continue  # and where the path through it is away, its candidate there comes by itself
        i = j
        for back in range(middle + 1):
            k = middle - back
            copy_into(paths[found, k], reached[k, i])
            i = parent[k, i]
        i = j
        for k in range(middle + 1, n):
            i = child[k - 1, i]
            _nearest_equivalent_into(
                candidates.q[k, i], paths[found, k - 1], turns, lower, upper, paths[found, k]
            )
        found += 1
    if _has_equivalents(turns, lower, upper):
        best, length = 0, np.inf
        for i in range(found):
            total = sequence_cost(paths[i], q_start, start_free, cost)
            if total < length:
                best, length = i, total
        shortest = shortest_over_equivalents(
            candidates.q, candidates.counts, to_go, q_start, start_free, turns, lower, upper, cost,
            paths[best].copy(), length * (1.0 + 1e-12)
        )  # fmt: skip
        for i in range(best):
            copy_rows_into(paths[best - i], paths[best - i - 1])
        copy_rows_into(paths[0], shortest)
    return paths[:found]


@kernel
def _is_distinct(rows: Array, q: Array, min_separation: float) -> bool:
    """Whether a configuration differs from each of the rows by so much in some joint."""
    for i in range(rows.shape[0]):
        largest = 0.0
        for d in range(q.shape[0]):
            largest = max(largest, abs(rows[i, d] - q[d]))
        if largest < min_separation:
            return False
    return True


@kernel
def _has_equivalents(turns: Flags, lower: Array, upper: Array) -> bool:
    """Whether a joint with limits has room for a full turn."""
    return bool(np.any(turns & np.isfinite(upper - lower)))
