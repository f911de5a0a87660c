"""Shortening of a joint motion by straight shortcuts, each proven to be free, compiled.

R. Geraerts and M. H. Overmars, "Creating high-quality paths for motion planning", 2007. Corners
are left out where a straight motion goes past them; then shortcuts between two random places are
taken, those that would gain next to nothing left untried.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.collision.scratch import Scratch
from ikplan.planning.moves.connect import SearchSpace, is_free

__all__ = ["path_length", "shorten"]


_LEAST_GAIN = 1e-3
"""Share of the whole length below which a shortcut is not worth its proof."""


@kernel
def path_length(q: Array) -> float:
    """Return the joint distance along a polyline of configurations, shape (k, dof)."""
    total = 0.0
    for k in range(q.shape[0] - 1):
        square = 0.0
        for d in range(q.shape[1]):
            square += (q[k + 1, d] - q[k, d]) ** 2
        total += math.sqrt(square)
    return total


@kernel
def _without_corners(space: SearchSpace, q: Array, w: Scratch) -> Array:
    """Leave out every corner that a straight motion goes past, from both ends inwards."""
    kept = np.empty_like(q)
    kept[0], count, at = q[0], 1, 0
    last = q.shape[0] - 1
    while at < last:
        to = last
        while to > at + 1 and not is_free(space, q[at], q[to], w):
            to -= 1
        kept[count] = q[to]
        count += 1
        at = to
    return kept[:count].copy()


@kernel
def _place(q: Array, lengths: Array, s: float) -> tuple[int, Array]:
    """Return the part of a polyline that a length along it is in, and the configuration there."""
    k = 0
    while k < lengths.shape[0] - 1 and s > lengths[k]:
        s -= lengths[k]
        k += 1
    share = min(s / lengths[k], 1.0) if lengths[k] > 0.0 else 0.0
    return k, q[k] + share * (q[k + 1] - q[k])


@kernel
def shorten(
    space: SearchSpace, q: Array, attempts: int, rng: np.random.Generator, w: Scratch
) -> Array:
    """Return a shorter motion with the same ends, every part of it proven to be free.

    Args:
        space: What it must not touch.
        q: Configurations between which the motion is straight, shape (k, dof) [rad or m].
        attempts: How many shortcuts are tried.
        rng: Draws their ends.
        w: Work space for the check.
    """
    q = _without_corners(space, q, w)
    for _ in range(attempts):
        parts = q.shape[0] - 1
        if parts < 2:
            return q
        lengths = np.empty(parts)
        for k in range(parts):
            lengths[k] = path_length(q[k : k + 2])
        total = lengths.sum()
        s0, s1 = total * rng.random(), total * rng.random()
        if s1 < s0:
            s0, s1 = s1, s0
        i, a = _place(q, lengths, s0)
        j, b = _place(q, lengths, s1)
        if i == j:
            continue
        square = 0.0
        for d in range(a.shape[0]):
            square += (b[d] - a[d]) ** 2
        if s1 - s0 - math.sqrt(square) < _LEAST_GAIN * total or not is_free(space, a, b, w):
            continue
        q = np.concatenate((q[: i + 1], a.reshape(1, -1), b.reshape(1, -1), q[j + 1 :]))
        # Ends of the shortcut that coincide with a corner would be there twice.
        kept = np.ones(q.shape[0], dtype=np.bool_)
        for k in range(1, q.shape[0] - 1):
            kept[k] = path_length(q[k - 1 : k + 1]) > 1e-9
        q = q[kept]
    return _without_corners(space, q, w)
