"""RRT-Connect: two trees of proven motions that grow towards each other, compiled.

J. J. Kuffner and S. M. LaValle, "RRT-Connect: An efficient approach to single-query path planning",
ICRA 2000. The smaller tree is extended always (balanced trees, J. J. Kuffner and S. M. LaValle,
"An efficient approach to path planning using balanced bidirectional RRT search", 2005), which puts
the effort on the confined end until it is out. Nodes whose extensions fail are given a smaller
domain (L. Jaillet et al., "Adaptive tuning of the sampling domain for dynamic-domain RRTs", 2005),
for the first part of the search only: afterwards a new search goes without it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.collision.bodies import Bodies
from ikplan.collision.motion import motion_free
from ikplan.collision.scratch import Scratch
from ikplan.kinematics.chain import Chain

__all__ = ["CUT", "SearchSpace", "connect", "is_free"]


CUT = -1
"""What stands for the samples drawn where a search was ended."""
_RANGE = 0.5
"""Longest extension, in the metric of the search."""
_DOMAIN, _SMALLEST_DOMAIN, _DOMAIN_RATE = 3.0, 0.7, 1e-4
"""First domain of a node whose extension fails, the smallest, and by how much it changes."""
_WITH_DOMAINS = 5000
"""Iterations of the search with domains."""


class SearchSpace(NamedTuple):
    """Where the trees grow, and what they must not touch.

    Attributes:
        chain: The chain of the arm.
        bodies: Bodies to be kept apart.
        active: Which pairs of them count, shape (m,).
        margin: Gap asked for on top of the clearance [m].
        lower: Lower bounds of the samples, shape (dof,) [rad or m].
        upper: Upper bounds of the samples, shape (dof,) [rad or m].
        weight: Weight of each joint in the metric, shape (dof,).
    """

    chain: Chain
    bodies: Bodies
    active: Flags
    margin: float
    lower: Array
    upper: Array
    weight: Array


class _Tree(NamedTuple):
    """Nodes of a tree.

    Attributes:
        q: Configurations, shape (cap, dof).
        parent: Indices of each node's parent, -1 of a root, shape (cap,).
        domain: Distance up to which samples count, shape (cap,).
    """

    q: Array
    parent: Indices
    domain: Array


@leaf_kernel
def _nearest(tree: _Tree, count: int, q: Array, weight: Array) -> tuple[int, float]:
    """Return the node nearest to q, and its distance."""
    best, at = math.inf, 0
    for k in range(count):
        square = 0.0
        for d in range(q.shape[0]):
            step = weight[d] * (tree.q[k, d] - q[d])
            square += step * step
            if square >= best:
                break
        if square < best:
            best, at = square, k
    return at, math.sqrt(best)


@leaf_kernel
def is_free(space: SearchSpace, a: Array, b: Array, w: Scratch) -> bool:
    """Whether the straight motion from a to b is proven to be free."""
    return motion_free(space.chain, space.bodies, space.active, space.margin, a, b, w)


@kernel
def _add(tree: _Tree, count: int, q: Array, parent: int) -> int:
    """Add a node; return the new count."""
    tree.q[count] = q
    tree.parent[count] = parent
    tree.domain[count] = math.inf
    return count + 1


@kernel
def _way_to_root(tree: _Tree, node: int) -> Array:
    """Return the configurations from a node to its root."""
    length, k = 0, node
    while k >= 0:
        length += 1
        k = tree.parent[k]
    way = np.empty((length, tree.q.shape[1]))
    k = node
    for i in range(length):
        way[i] = tree.q[k]
        k = tree.parent[k]
    return way


@kernel
def _search(
    space: SearchSpace,
    q_start: Array,
    goals: Array,
    iterations: int,
    domains: bool,
    rng: np.random.Generator,
    cut: Flags,
    w: Scratch,
) -> tuple[Array, int]:
    """Grow both trees; return the path, empty where none is found, and the iterations used."""
    dof = q_start.shape[0]
    cap = 512
    trees = (
        _Tree(np.empty((cap, dof)), np.empty(cap, dtype=np.int64), np.empty(cap)),
        _Tree(np.empty((cap, dof)), np.empty(cap, dtype=np.int64), np.empty(cap)),
    )
    one, other = trees
    n_one, n_other = _add(one, 0, q_start, -1), 0
    for k in range(min(goals.shape[0], cap // 2)):
        n_other = _add(other, n_other, goals[k], -1)
    swapped = False
    q, q_new = np.empty(dof), np.empty(dof)
    for iteration in range(iterations):
        if cut[0]:
            return np.empty((0, dof)), CUT
        if n_other < n_one:
            one, other = other, one
            n_one, n_other = n_other, n_one
            swapped = not swapped
        # Room for this extension, and for all the steps towards it in the other tree.
        if n_one + 2 > one.q.shape[0]:
            one = _Tree(
                np.concatenate((one.q, np.empty_like(one.q))),
                np.concatenate((one.parent, np.empty_like(one.parent))),
                np.concatenate((one.domain, np.empty_like(one.domain))),
            )
        for d in range(dof):
            q[d] = space.lower[d] + rng.random() * (space.upper[d] - space.lower[d])
        near, distance = _nearest(one, n_one, q, space.weight)
        if distance == 0.0 or (domains and distance > one.domain[near]):
            continue
        share = min(1.0, _RANGE / distance)
        for d in range(dof):
            q_new[d] = one.q[near, d] + share * (q[d] - one.q[near, d])
        if not is_free(space, one.q[near], q_new, w):
            if domains:
                narrowed = one.domain[near] * (1.0 - _DOMAIN_RATE)
                one.domain[near] = (
                    _DOMAIN if math.isinf(one.domain[near]) else max(narrowed, _SMALLEST_DOMAIN)
                )
            continue
        if domains and not math.isinf(one.domain[near]):
            one.domain[near] *= 1.0 + _DOMAIN_RATE
        n_one = _add(one, n_one, q_new, near)
        near, distance = _nearest(other, n_other, q_new, space.weight)
        steps = max(math.ceil(distance / _RANGE), 1)
        while n_other + steps + 2 > other.q.shape[0]:
            other = _Tree(
                np.concatenate((other.q, np.empty_like(other.q))),
                np.concatenate((other.parent, np.empty_like(other.parent))),
                np.concatenate((other.domain, np.empty_like(other.domain))),
            )
        begin, at, joined = other.q[near].copy(), near, True
        for step in range(steps):
            share = (step + 1) / steps
            for d in range(dof):
                q[d] = begin[d] + share * (q_new[d] - begin[d])
            if not is_free(space, other.q[at], q, w):
                joined = False
                break
            if step + 1 < steps:
                n_other = _add(other, n_other, q, at)
                at = n_other - 1
        if joined:
            first, second = _way_to_root(one, n_one - 1), _way_to_root(other, at)
            if swapped:
                first, second = second, first
            return np.concatenate((first[::-1], second)), iteration + 1
    return np.empty((0, dof)), iterations


@kernel
def connect(
    space: SearchSpace,
    q_start: Array,
    goals: Array,
    iterations: int,
    rng: np.random.Generator,
    cut: Flags,
    w: Scratch,
) -> tuple[Array, int]:
    """Find a joint motion from a start to any of some goals, every part of it proven to be free.

    Args:
        space: Where to look.
        q_start: The start, free of contact, shape (dof,) [rad or m].
        goals: The goals, free of contact, shape (g, dof), g >= 1 [rad or m].
        iterations: Most samples drawn.
        rng: Draws the samples.
        cut: Shape (1,): true, set by another thread, ends the search.
        w: Work space for the check.

    Returns:
        Configurations from the start to a goal, shape (k, dof), between which the motion is
        straight, empty where none was found, and the samples drawn, ``CUT`` where the search was
        ended.
    """
    first = min(iterations, _WITH_DOMAINS)
    path, used = _search(space, q_start, goals, first, True, rng, cut, w)
    if path.shape[0] == 0 and used != CUT and iterations > first:
        path, more = _search(space, q_start, goals, iterations - first, False, rng, cut, w)
        used = CUT if more == CUT else used + more
    return path, used
