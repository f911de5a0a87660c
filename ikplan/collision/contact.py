"""Whether configurations, and straight joint motions between them, are free of contact, compiled.

A motion is proven by halving: at the middle of an interval a pair whose gap is larger than what its
outer body can move within the interval is free throughout; other pairs are looked at again in both
halves. What a body can move is summed from its carrier inwards, about the joint axes at the middle:
a joint that turns by up to d moves a point at distance r from its axis by at most d r.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel
from ikplan.collision.bodies import Bodies
from ikplan.collision.frames import link_frames
from ikplan.collision.gjk import gap_between
from ikplan.kinematics.chain import Chain

__all__ = ["Scratch", "contacts", "gaps", "motion_contact", "new_scratch"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

_FINEST = 2e-5
"""Motion of the outer body within an interval below which it is not halved any more [m]."""


class Scratch(NamedTuple):
    """Work space of the kernels; the axes are carried over from one configuration to the next.

    Attributes:
        R: Rotations of the links, shape (n + 1, 3, 3).
        p: Origins of the links, shape (n + 1, 3) [m].
        centre: Centres of the pieces in the base, shape (k, 3) [m].
        axis: Separating axis of each pair when it was last looked at, shape (m, 3).
        work: For the distance of two pieces, shape (12, 3).
    """

    R: Array
    p: Array
    centre: Array
    axis: Array
    work: Array


@kernel
def new_scratch(chain: Chain, bodies: Bodies) -> Scratch:
    """Return work space for a chain and its bodies."""
    n = chain.prismatic.shape[0] + 1
    return Scratch(
        np.zeros((n, 3, 3)),
        np.zeros((n, 3)),
        np.zeros((bodies.radius.shape[0], 3)),
        np.zeros((bodies.pairs.shape[0], 3)),
        np.zeros((12, 3)),
    )


@kernel
def _place(chain: Chain, bodies: Bodies, q: Array, w: Scratch) -> None:
    """Write the link frames and the centres of the pieces at a configuration."""
    link_frames(chain, q, w.R, w.p)
    for i in range(bodies.radius.shape[0]):
        c = bodies.carrier[i]
        for k in range(3):
            w.centre[i, k] = (
                w.p[c, k]
                + w.R[c, k, 0] * bodies.centre[i, 0]
                + w.R[c, k, 1] * bodies.centre[i, 1]
                + w.R[c, k, 2] * bodies.centre[i, 2]
            )


@kernel
def _sphere_gap(bodies: Bodies, i: int, j: int, w: Scratch) -> float:
    """Return the gap of the spheres about two pieces [m]."""
    square = 0.0
    for k in range(3):
        square += (w.centre[i, k] - w.centre[j, k]) ** 2
    return math.sqrt(square) - float(bodies.bound[i] + bodies.bound[j])


@kernel
def _gap(bodies: Bodies, row: int, need: float, enough: float, w: Scratch) -> tuple[float, float]:
    """Bound the gap of a pair at the placed configuration; see :func:`gap_between`."""
    i, j = bodies.pairs[row]
    a, b = bodies.carrier[i], bodies.carrier[j]
    reach = bodies.radius[i] + bodies.radius[j]
    axis = w.axis[row]
    if axis[0] == 0.0 and axis[1] == 0.0 and axis[2] == 0.0:
        for k in range(3):
            axis[k] = w.centre[i, k] - w.centre[j, k]
    lower, upper = gap_between(
        bodies.points,
        (bodies.first[i], bodies.first[i + 1]), w.R[a], w.p[a],
        (bodies.first[j], bodies.first[j + 1]), w.R[b], w.p[b],
        need + reach, enough + reach, axis, w.work,
    )  # fmt: skip
    return lower - reach, upper - reach


@kernel
def _contact(chain: Chain, bodies: Bodies, active: Flags, need: float, q: Array, w: Scratch) -> int:
    """Return the first pair whose gap is not larger than needed, -1 where there is none."""
    _place(chain, bodies, q, w)
    for row in range(bodies.pairs.shape[0]):
        if not active[row]:
            continue
        i, j = bodies.pairs[row]
        if _sphere_gap(bodies, i, j, w) > need:
            continue
        if not _gap(bodies, row, need, need, w)[0] > need:
            return row
    return -1


@kernel
def contacts(
    chain: Chain, bodies: Bodies, active: Flags, margin: float, q: Array, w: Scratch, out: Index
) -> None:
    """Write for each configuration the first pair nearer than allowed.

    Args:
        chain: The chain.
        bodies: The bodies.
        active: Which pairs count, shape (m,).
        margin: Gap asked for on top of the clearance [m].
        q: Configurations, shape (c, dof) [rad or m].
        w: Work space.
        out: Out: row of the pair, -1 where all are free, shape (c,).
    """
    for c in range(q.shape[0]):
        out[c] = _contact(chain, bodies, active, bodies.clearance + margin, q[c], w)


@kernel
def gaps(
    chain: Chain, bodies: Bodies, active: Flags, q: Array, most: float, w: Scratch, out: Array
) -> int:
    """Write the gap of every pair at a configuration, as far as it is below ``most``.

    Args:
        chain: The chain.
        bodies: The bodies.
        active: Which pairs count, shape (m,).
        q: Joint values, shape (dof,) [rad or m].
        most: Gaps above this are not looked at closely [m].
        w: Work space.
        out: Out: a lower bound of the gap of each pair, shape (m,) [m].

    Returns:
        The row of the smallest, -1 where there is none.
    """
    _place(chain, bodies, q, w)
    least, at = math.inf, -1
    for row in range(bodies.pairs.shape[0]):
        out[row] = math.inf
        if not active[row]:
            continue
        i, j = bodies.pairs[row]
        out[row] = _sphere_gap(bodies, i, j, w)
        if out[row] <= most:
            out[row] = _gap(bodies, row, most, -math.inf, w)[0]
        if out[row] < least:
            least, at = out[row], row
    return at


@kernel
def _motion_of(chain: Chain, bodies: Bodies, row: int, reach: Array, w: Scratch) -> float:
    """Bound how far the outer piece of a pair moves against the inner one [m].

    Args:
        chain: The chain.
        bodies: The bodies.
        row: The pair.
        reach: How far each serial joint moves from the placed configuration, shape (n,).
        w: Work space.
    """
    i, j = bodies.pairs[row]
    inner, outer = bodies.carrier[i], bodies.carrier[j]
    total = 0.0
    for back in range(outer - inner):
        joint = outer - back
        if chain.prismatic[joint - 1]:
            total += reach[joint - 1]
            continue
        along, square = 0.0, 0.0
        for k in range(3):
            d = w.centre[j, k] - w.p[joint, k]
            along += d * w.R[joint, k, 2]
            square += d * d
        arm = math.sqrt(max(square - along * along, 0.0)) + bodies.bound[j]
        total += reach[joint - 1] * (arm + total)
    return total


@kernel
def _grown(array: Array) -> Array:
    """Return an array with room for as many rows again."""
    return np.concatenate((array, np.empty_like(array)))


@kernel
def motion_contact(
    chain: Chain,
    bodies: Bodies,
    active: Flags,
    margin: float,
    q_begin: Array,
    q_end: Array,
    w: Scratch,
) -> tuple[int, float]:
    """Look for contact on the straight joint motion between two configurations, its ends included.

    Args:
        chain: The chain.
        bodies: The bodies.
        active: Which pairs count, shape (m,).
        margin: Gap asked for on top of the clearance [m].
        q_begin: Where it begins, shape (dof,) [rad or m].
        q_end: Where it ends, shape (dof,) [rad or m].
        w: Work space.

    Returns:
        The row of a pair that is nearer than allowed, or cannot be proven to be farther, and the
        share of the motion at which; -1 and 0 where the whole motion is proven to be free.
    """
    need = bodies.clearance + margin
    at_end = _contact(chain, bodies, active, need, q_end, w)
    if at_end >= 0:
        return at_end, 1.0
    n, dof = chain.prismatic.shape[0], q_begin.shape[0]
    whole = np.zeros(n)
    for i in range(n):
        if chain.coupled:
            for d in range(dof):
                whole[i] += abs(chain.coupling[i, d] * (q_end[d] - q_begin[d]))
        else:
            whole[i] = abs(q_end[i] - q_begin[i])
    open_pairs = np.empty(max(64, 2 * bodies.pairs.shape[0]), dtype=np.int64)
    size = 0
    for row in range(bodies.pairs.shape[0]):
        if active[row]:
            open_pairs[size] = row
            size += 1
    middle, half = np.empty(64), np.empty(64)
    begin, end = np.empty(64, dtype=np.int64), np.empty(64, dtype=np.int64)
    middle[0], half[0], begin[0], end[0] = 0.5, 0.5, 0, size
    at, nodes = 0, 1
    q, reach = np.empty(dof), np.empty(n)
    while at < nodes:
        t, h = middle[at], half[at]
        for d in range(dof):
            q[d] = q_begin[d] + t * (q_end[d] - q_begin[d])
        for i in range(n):
            reach[i] = h * whole[i]
        _place(chain, bodies, q, w)
        left = size
        for k in range(begin[at], end[at]):
            row = open_pairs[k]
            i, j = bodies.pairs[row]
            motion = _motion_of(chain, bodies, row, reach, w)
            if _sphere_gap(bodies, i, j, w) > need + motion:
                continue
            lower, upper = _gap(bodies, row, need + motion, need, w)
            if lower > need + motion:
                continue
            if upper <= need or not lower > need or motion < _FINEST:
                return row, t
            if size == open_pairs.shape[0]:
                open_pairs = np.concatenate((open_pairs, np.empty_like(open_pairs)))
            open_pairs[size] = row
            size += 1
        if size > left:
            if nodes + 2 > middle.shape[0]:
                middle, half = _grown(middle), _grown(half)
                begin = np.concatenate((begin, np.empty_like(begin)))
                end = np.concatenate((end, np.empty_like(end)))
            for side in range(2):
                middle[nodes] = t + (0.5 if side else -0.5) * h
                half[nodes], begin[nodes], end[nodes] = 0.5 * h, left, size
                nodes += 1
        at += 1
    return -1, 0.0
