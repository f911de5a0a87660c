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

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.collision.bodies import Bodies
from ikplan.collision.capsules import segment_distance
from ikplan.collision.frames import link_frames
from ikplan.collision.gjk import gap_between
from ikplan.kinematics.chain import Chain

__all__ = ["Scratch", "contacts", "gaps", "motion_contact", "new_scratch"]


_FINEST = 2e-5
"""Motion of the outer body within an interval below which it is not halved any more [m]."""


class Queue(NamedTuple):
    """Intervals of a motion that are still to be looked at.

    Attributes:
        middle: Middle of each interval, as a share of the motion, shape (k,).
        half: Half of its length, shape (k,).
        begin: First of its open pairs in ``rows``, shape (k,).
        end: Last of them (exclusive), shape (k,).
        rows: Open pairs of all intervals.
        whole: How far each serial joint moves, shape (n,).
        reach: How far from the middle of the interval, shape (n,).
        q: The configuration there, shape (dof,).
    """

    middle: Array
    half: Array
    begin: Indices
    end: Indices
    rows: Indices
    whole: Array
    reach: Array
    q: Array


class Scratch(NamedTuple):
    """Work space of the kernels; the axes are carried over from one configuration to the next.

    Attributes:
        R: Rotations of the links, shape (n + 1, 3, 3).
        p: Origins of the links, shape (n + 1, 3) [m].
        centre: Centres of the pieces in the base, shape (k, 3) [m].
        ends: Both ends of the capsules' axes in the base, shape (k, 6) [m].
        motion: How far each piece can move against each link, shape (k, n + 1) [m].
        axis: Separating axis of each pair when it was last looked at, shape (m, 3).
        work: For the distance of two pieces, shape (12, 3).
        queue: For the proof of a motion.
    """

    R: Array
    p: Array
    centre: Array
    ends: Array
    motion: Array
    axis: Array
    work: Array
    queue: Queue


@kernel
def new_queue(chain: Chain, bodies: Bodies, dof: int, room: int) -> Queue:
    """Return a queue with room for 64 intervals times ``room``."""
    n = chain.prismatic.shape[0]
    return Queue(
        np.zeros(64 * room),
        np.zeros(64 * room),
        np.zeros(64 * room, dtype=np.int64),
        np.zeros(64 * room, dtype=np.int64),
        np.zeros(4 * room * bodies.pairs.shape[0], dtype=np.int64),
        np.zeros(n),
        np.zeros(n),
        np.zeros(dof),
    )


@kernel
def new_scratch(chain: Chain, bodies: Bodies) -> Scratch:
    """Return work space for a chain and its bodies."""
    n = chain.prismatic.shape[0] + 1
    return Scratch(
        np.zeros((n, 3, 3)),
        np.zeros((n, 3)),
        np.zeros((bodies.radius.shape[0], 3)),
        np.zeros((bodies.radius.shape[0], 6)),
        np.zeros((bodies.radius.shape[0], n)),
        np.zeros((bodies.pairs.shape[0], 3)),
        np.zeros((12, 3)),
        new_queue(chain, bodies, chain.coupling.shape[1], 2),
    )


@leaf_kernel
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
            for end in (0, 3):
                w.ends[i, end + k] = (
                    w.p[c, k]
                    + w.R[c, k, 0] * bodies.axis[i, end]
                    + w.R[c, k, 1] * bodies.axis[i, end + 1]
                    + w.R[c, k, 2] * bodies.axis[i, end + 2]
                )


@leaf_kernel
def _sphere_gap(bodies: Bodies, i: int, j: int, w: Scratch) -> float:
    """Return the gap of the spheres about two pieces [m]."""
    square = 0.0
    for k in range(3):
        square += (w.centre[i, k] - w.centre[j, k]) ** 2
    return math.sqrt(square) - float(bodies.bound[i] + bodies.bound[j])


@leaf_kernel
def _farther(bodies: Bodies, i: int, j: int, need: float, w: Scratch) -> bool:
    """Whether the spheres or the capsules about two pieces already have more than a gap."""
    if _sphere_gap(bodies, i, j, w) > need:
        return True
    around = bodies.around[i] + bodies.around[j]
    return bool(segment_distance(w.ends, i, j) - around > need)


@leaf_kernel
def _gap(bodies: Bodies, row: int, need: float, enough: float, w: Scratch) -> tuple[float, float]:
    """Bound the gap of a pair at the placed configuration; see :func:`gap_between`."""
    i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
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


@leaf_kernel
def _contact(chain: Chain, bodies: Bodies, active: Flags, need: float, q: Array, w: Scratch) -> int:
    """Return the first pair whose gap is not larger than needed, -1 where there is none."""
    _place(chain, bodies, q, w)
    for row in range(bodies.pairs.shape[0]):
        if not active[row]:
            continue
        i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
        if _farther(bodies, i, j, need, w):
            continue
        if not _gap(bodies, row, need, need, w)[0] > need:
            return row
    return -1


@leaf_kernel
def contacts(
    chain: Chain, bodies: Bodies, active: Flags, margin: float, q: Array, w: Scratch, out: Indices
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


@leaf_kernel
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
        i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
        out[row] = _sphere_gap(bodies, i, j, w)
        if out[row] <= most:
            out[row] = _gap(bodies, row, most, math.nan, w)[0]  # to the end: no gap is enough
        if out[row] < least:
            least, at = out[row], row
    return at


@leaf_kernel
def _move_pieces(chain: Chain, bodies: Bodies, reach: Array, w: Scratch) -> None:
    """Write how far each piece can move against each link inwards of its carrier [m].

    Args:
        chain: The chain.
        bodies: The bodies.
        reach: How far each serial joint moves from the placed configuration, shape (n,).
        w: Work space; its ``motion`` is written.
    """
    for i in range(bodies.radius.shape[0]):
        total = 0.0
        outer = bodies.carrier[i]
        w.motion[i, outer] = 0.0
        for back in range(outer):
            joint = outer - back
            if chain.prismatic[joint - 1]:
                total += reach[joint - 1]
            elif reach[joint - 1] > 0.0:
                along, square = 0.0, 0.0
                for k in range(3):
                    d = w.centre[i, k] - w.p[joint, k]
                    along += d * w.R[joint, k, 2]
                    square += d * d
                arm = math.sqrt(max(square - along * along, 0.0)) + bodies.bound[i]
                total += reach[joint - 1] * (arm + total)
            w.motion[i, joint - 1] = total


@leaf_kernel
def _reach_of(chain: Chain, q_begin: Array, q_end: Array, whole: Array) -> None:
    """Write how far each serial joint moves between two configurations, shape (n,)."""
    for i in range(chain.prismatic.shape[0]):
        whole[i] = 0.0
        if chain.coupled:
            for d in range(q_begin.shape[0]):
                whole[i] += abs(chain.coupling[i, d] * (q_end[d] - q_begin[d]))
        else:
            whole[i] = abs(q_end[i] - q_begin[i])


@leaf_kernel
def _halve(
    chain: Chain,
    bodies: Bodies,
    active: Flags,
    need: float,
    q_begin: Array,
    q_end: Array,
    w: Scratch,
    queue: Queue,
) -> tuple[int, float]:
    """Prove a motion by halving, widest intervals first; see :func:`motion_contact`.

    Returns:
        What :func:`motion_contact` returns, or -2 where the queue has no more room.
    """
    n, dof = chain.prismatic.shape[0], q_begin.shape[0]
    whole, reach, q = queue.whole, queue.reach, queue.q
    _reach_of(chain, q_begin, q_end, whole)
    size = 0
    for row in range(bodies.pairs.shape[0]):
        if active[row]:
            queue.rows[size] = row
            size += 1
    queue.middle[0], queue.half[0] = 0.5, 0.5
    queue.begin[0], queue.end[0] = 0, size
    at, nodes = 0, 1
    while at < nodes:
        t, h = queue.middle[at], queue.half[at]
        for d in range(dof):
            q[d] = q_begin[d] + t * (q_end[d] - q_begin[d])
        for i in range(n):
            reach[i] = h * whole[i]
        _place(chain, bodies, q, w)
        _move_pieces(chain, bodies, reach, w)
        left = size
        if size + queue.end[at] - queue.begin[at] > queue.rows.shape[0]:
            return -2, 0.0
        for k in range(queue.begin[at], queue.end[at]):
            row = queue.rows[k]
            i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
            motion = w.motion[j, bodies.carrier[i]]
            if _farther(bodies, i, j, need + motion, w):
                continue
            lower, upper = _gap(bodies, row, need + motion, need, w)
            if lower > need + motion:
                continue
            if upper <= need or not lower > need or motion < _FINEST:
                return row, t
            queue.rows[size] = row
            size += 1
        if size > left:
            if nodes + 2 > queue.middle.shape[0]:
                return -2, 0.0
            for side in range(2):
                queue.middle[nodes] = t + (0.5 if side else -0.5) * h
                queue.half[nodes] = 0.5 * h
                queue.begin[nodes], queue.end[nodes] = left, size
                nodes += 1
        at += 1
    return -1, 0.0


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
    row, share = _halve(chain, bodies, active, need, q_begin, q_end, w, w.queue)
    room = 4
    while row == -2:
        larger = new_queue(chain, bodies, q_begin.shape[0], room)
        row, share = _halve(chain, bodies, active, need, q_begin, q_end, w, larger)
        room *= 4
    return row, share
