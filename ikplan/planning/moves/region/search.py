"""RRT-Connect in steps that are projected into a region, and shortcuts within it, compiled.

D. Berenson, S. Srinivasa and J. Kuffner, "Task Space Regions: A framework for pose-constrained
manipulation planning", International Journal of Robotics Research 30 (12), 2011: both trees grow
by short steps, each of them projected; every edge is proven, here to be free and within the region.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.collision.scratch import Scratch
from ikplan.planning.moves.connect import CUT, SearchSpace, is_free
from ikplan.planning.moves.region.kernels import project, straight_inside
from ikplan.planning.moves.region.tool_region import RegionScratch, ToolRegion
from ikplan.planning.moves.shorten import path_length

__all__ = ["SHARE", "connect_within", "passable", "shorten_within"]

SHARE = 0.97
"""Share of the region that the edges of a way keep within: rounded corners and the timed motion
have the rest."""
_STEP = 0.15
"""Length of a step, in the metric of the search."""
_MOST_STEPS = 8
"""Steps of one extension."""


@kernel
def passable(
    space: SearchSpace, region: ToolRegion, a: Array, b: Array, w: Scratch, v: RegionScratch
) -> bool:
    """Whether the straight motion from a to b is proven to be free and within the region."""
    return straight_inside(region, SHARE, a, b, v) and is_free(space, a, b, w)


@kernel
def _distance(weight: Array, a: Array, b: Array) -> float:
    square = 0.0
    for d in range(a.shape[0]):
        square += (weight[d] * (a[d] - b[d])) ** 2
    return math.sqrt(square)


@kernel
def _nearest(q: Array, count: int, to: Array, weight: Array) -> int:
    best, at = math.inf, 0
    for k in range(count):
        distance = _distance(weight, q[k], to)
        if distance < best:
            best, at = distance, k
    return at


@kernel
def _extend(
    space: SearchSpace,
    region: ToolRegion,
    q: Array,
    parent: Indices,
    count: int,
    near: int,
    to: Array,
    steps: int,
    w: Scratch,
    v: RegionScratch,
) -> tuple[int, int, bool]:
    """Grow a tree by projected steps; return its size, its last node, and whether it is there."""
    at, left = near, _distance(space.weight, q[near], to)
    q_new = np.empty(to.shape[0])
    for _ in range(steps):
        if count >= q.shape[0]:
            break
        if left <= _STEP:
            q_new[:] = to
            if passable(space, region, q[at], q_new, w, v):
                q[count], parent[count] = q_new, at
                return count + 1, count, True
        share = min(1.0, _STEP / left) if left > 0.0 else 1.0
        for d in range(to.shape[0]):
            q_new[d] = q[at, d] + share * (to[d] - q[at, d])
        if not project(region, space.lower, space.upper, q_new, v):
            break
        now = _distance(space.weight, q_new, to)
        if now > left - 0.1 * _STEP or not passable(space, region, q[at], q_new, w, v):
            break
        q[count], parent[count] = q_new, at
        at, left = count, now
        count += 1
    return count, at, False


@kernel
def _to_root(q: Array, parent: Indices, node: int) -> Array:
    length, k = 0, node
    while k >= 0:
        length += 1
        k = parent[k]
    way = np.empty((length, q.shape[1]))
    k = node
    for i in range(length):
        way[i] = q[k]
        k = parent[k]
    return way


@kernel
def connect_within(
    space: SearchSpace,
    region: ToolRegion,
    q_start: Array,
    goals: Array,
    iterations: int,
    rng: np.random.Generator,
    cut: Flags,
    w: Scratch,
    v: RegionScratch,
) -> tuple[Array, int]:
    """Find a joint motion within a region, every part of it proven to be free and inside.

    Args:
        space: Where to look.
        region: Where the tool may be.
        q_start: The start, free and inside, shape (dof,) [rad or m].
        goals: The goals, free and inside, shape (g, dof), g >= 1 [rad or m].
        iterations: Most samples drawn.
        rng: Draws the samples.
        cut: Shape (1,): true, set by another thread, ends the search.
        w: Work space for the check of contact.
        v: Work space for the region.

    Returns:
        Configurations from the start to a goal, shape (k, dof), empty where none was found, and
        the samples drawn, ``CUT`` where the search was ended.
    """
    dof = q_start.shape[0]
    cap = 2 * _MOST_STEPS * 64
    q_one, q_other = np.empty((cap, dof)), np.empty((cap, dof))
    up_one, up_other = np.empty(cap, dtype=np.int64), np.empty(cap, dtype=np.int64)
    q_one[0], up_one[0], n_one, n_other = q_start, -1, 1, 0
    for k in range(min(goals.shape[0], cap // 2)):
        q_other[k], up_other[k] = goals[k], -1
        n_other += 1
    swapped = False
    q = np.empty(dof)
    for iteration in range(iterations):
        if cut[0]:
            return np.empty((0, dof)), CUT
        if n_other < n_one:
            q_one, q_other, up_one, up_other = q_other, q_one, up_other, up_one
            n_one, n_other, swapped = n_other, n_one, not swapped
        if n_one + _MOST_STEPS > q_one.shape[0]:
            q_one = np.concatenate((q_one, np.empty_like(q_one)))
            up_one = np.concatenate((up_one, np.empty_like(up_one)))
        while n_other + 16 * _MOST_STEPS > q_other.shape[0]:
            q_other = np.concatenate((q_other, np.empty_like(q_other)))
            up_other = np.concatenate((up_other, np.empty_like(up_other)))
        for d in range(dof):
            q[d] = space.lower[d] + rng.random() * (space.upper[d] - space.lower[d])
        near = _nearest(q_one, n_one, q, space.weight)
        grown, last, _ = _extend(space, region, q_one, up_one, n_one, near, q, _MOST_STEPS, w, v)
        if grown == n_one:
            continue
        n_one = grown
        near = _nearest(q_other, n_other, q_one[last], space.weight)
        n_other, reached, joined = _extend(
            space, region, q_other, up_other, n_other, near, q_one[last].copy(), 100, w, v
        )
        if joined:
            first, second = _to_root(q_one, up_one, last), _to_root(q_other, up_other, reached)
            # The node that both have is in the way once.
            if swapped:
                return np.concatenate((second[::-1], first[1:])), iteration + 1
            return np.concatenate((first[::-1], second[1:])), iteration + 1
    return np.empty((0, dof)), iterations


@kernel
def _straightened(
    space: SearchSpace, region: ToolRegion, q: Array, w: Scratch, v: RegionScratch
) -> Array:
    """Leave out corners that a straight motion goes past, each time from as far as it can."""
    kept = np.empty_like(q)
    kept[0], count, at, last = q[0], 1, 0, q.shape[0] - 1
    while at < last:
        to = last
        while to > at + 1 and not passable(space, region, q[at], q[to], w, v):
            to -= 1
        kept[count] = q[to]
        count += 1
        at = to
    return kept[:count].copy()


@kernel
def shorten_within(
    space: SearchSpace,
    region: ToolRegion,
    q: Array,
    attempts: int,
    rng: np.random.Generator,
    w: Scratch,
    v: RegionScratch,
) -> Array:
    """Return a shorter motion with the same ends, every part of it free and inside.

    Args:
        space: What it must not touch.
        region: Where the tool may be.
        q: Configurations between which the motion is straight, shape (k, dof) [rad or m].
        attempts: How many shortcuts are tried.
        rng: Draws their ends.
        w: Work space for the check of contact.
        v: Work space for the region.
    """
    q = _straightened(space, region, q, w, v)
    for _ in range(attempts):
        parts = q.shape[0] - 1
        if parts < 2:
            return q
        s0, s1 = rng.random() * parts, rng.random() * parts
        if s1 < s0:
            s0, s1 = s1, s0
        i, j = min(int(s0), parts - 1), min(int(s1), parts - 1)
        if i == j:
            continue
        a = q[i] + (s0 - i) * (q[i + 1] - q[i])
        b = q[j] + (s1 - j) * (q[j + 1] - q[j])
        if not passable(space, region, a, b, w, v):
            continue
        shorter = np.concatenate((q[: i + 1], a.reshape(1, -1), b.reshape(1, -1), q[j + 1 :]))
        if path_length(shorter) > path_length(q) - 1e-9:
            continue
        kept = np.ones(shorter.shape[0], dtype=np.bool_)
        for k in range(1, shorter.shape[0] - 1):
            kept[k] = path_length(shorter[k - 1 : k + 1]) > 1e-9
        q = shorter[kept]
    return _straightened(space, region, q, w, v)
