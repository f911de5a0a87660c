"""Whether joint motions, straight or cubic, are free of contact, compiled.

A motion is proven by halving: at the middle of an interval a pair whose gap is larger than what its
outer body can move within the interval is free throughout; other pairs are looked at again in both
halves.
"""

from __future__ import annotations

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.collision.bodies import Bodies
from ikplan.collision.contact import any_pair, first_pair
from ikplan.collision.pair_gaps import place_pieces, sphere_gap, swept_gap
from ikplan.collision.scratch import Queue, Scratch
from ikplan.collision.sweep import cover_proven, move_links, move_piece, spheres_moved, sweep_pair
from ikplan.kinematics.chain import Chain

__all__ = ["curve_contacts", "motion_contact", "motion_free", "reach_of"]


_LOOSE = 0.015
"""By how much the gap of hulls is at times larger than its cheap bound [m]: a guess that decides
when they are compared, never what is proven."""
_SHARE = 0.7
"""By how much the gap is at times larger than that of the spheres, in the radii of both."""
_FINEST = 2e-5
"""Motion of the outer body within an interval below which it is not halved any more [m]."""

_NO_ROOM = -2


@leaf_kernel
def reach_of(chain: Chain, queue: Queue, t: float, h: float) -> None:
    """Write the configuration at a share t, and how each serial joint moves within h of it.

    The motion is ``c0 + c1 t + c2 t^2 + c3 t^3``: within h of t no joint value moves by more than
    h times the sum of the largest absolute values that the terms of its derivative take there.
    """
    step = queue.step
    c = queue.curve
    for d in range(c.shape[1]):
        queue.q[d] = c[0, d] + t * (c[1, d] + t * (c[2, d] + t * c[3, d]))
        speed = c[1, d] + t * (2.0 * c[2, d] + 3.0 * t * c[3, d])
        turn = abs(2.0 * c[2, d] + 6.0 * t * c[3, d])
        step[0, d] = h * (abs(speed) + h * turn + 3.0 * h * h * abs(c[3, d]))
        step[1, d] = h * speed
        step[2, d] = h * h * (turn + 6.0 * h * abs(c[3, d]))
    for i in range(chain.prismatic.shape[0]):
        if chain.coupled:
            queue.reach[i] = queue.speed[i] = queue.turn[i] = 0.0
            for d in range(c.shape[1]):
                queue.reach[i] += abs(chain.coupling[i, d]) * step[0, d]
                queue.speed[i] += chain.coupling[i, d] * step[1, d]
                queue.turn[i] += abs(chain.coupling[i, d]) * step[2, d]
        else:
            queue.reach[i], queue.speed[i], queue.turn[i] = step[0, i], step[1, i], step[2, i]


@leaf_kernel
def _halve(
    chain: Chain,
    bodies: Bodies,
    active: Flags,
    need: float,
    w: Scratch,
    middle: float,
    half: float,
) -> tuple[int, float]:
    """Prove an interval of the motion in the queue by halving, widest intervals first.

    Returns:
        What :func:`motion_contact` returns, or ``_NO_ROOM`` and 0 where the queue is full.
    """
    queue, size = w.queue, 0
    for top in bodies.tops:
        if active[top]:
            queue.rows[size] = top
            size += 1
    queue.middle[0], queue.half[0] = middle, half
    queue.begin[0], queue.end[0] = 0, size
    at, nodes = 0, 1
    while at < nodes:
        t, h = queue.middle[at], queue.half[at]
        reach_of(chain, queue, t, h)
        place_pieces(chain, bodies, queue.q, w)
        move_links(chain, queue, w)
        left = size
        # All in one loop: a call with these arguments costs more than most of its steps.
        k, part, last_part = queue.begin[at], 0, 0
        while part < last_part or k < queue.end[at]:
            if part < last_part:
                row = part
                part += 1
            else:
                row = queue.rows[k]
                k += 1
            i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
            if w.moved[j] != w.now[0]:
                move_piece(chain, bodies, queue, j, w)
            apart = sphere_gap(bodies, i, j, w)
            if apart > need + w.motion[j, bodies.carrier[i]]:
                continue
            sweep_pair(bodies, i, j, w)
            motion = spheres_moved(i, j, w)
            if apart > need + motion:
                continue
            # Looked at closely unless it is not in contact here and far from being proven.
            if not (apart > need and motion > apart + _SHARE * (bodies.bound[i] + bodies.bound[j])):
                bound, proven = cover_proven(bodies, i, j, need, w)
                if proven:
                    continue
                if bodies.parts[row, 1] > 0:
                    part, last_part = bodies.parts[row, 0], bodies.parts[row, 1]
                    continue
                if bound <= need or need + motion < bound + _LOOSE:
                    lower, upper, proven = swept_gap(bodies, row, need, need, w.sweep, w)
                    if proven:
                        continue
                    if upper <= need or not lower > need or w.sweep[8] < _FINEST:
                        return row, t
            if size == queue.rows.shape[0]:
                return _NO_ROOM, 0.0
            queue.rows[size] = row
            size += 1
        if size > left:
            if nodes + 2 > queue.middle.shape[0]:
                return _NO_ROOM, 0.0
            for side in range(2):
                queue.middle[nodes] = t + (0.5 if side else -0.5) * h
                queue.half[nodes] = 0.5 * h
                queue.begin[nodes], queue.end[nodes] = left, size
                nodes += 1
        at += 1
    return -1, 0.0


@leaf_kernel
def _proven(
    chain: Chain, bodies: Bodies, active: Flags, need: float, w: Scratch
) -> tuple[int, float]:
    """Prove the motion in the queue of the work space, in parts where it has no room for all."""
    later = w.queue.later
    later[0, 0], later[0, 1] = 0.5, 0.5
    waiting = 1
    while waiting > 0:
        waiting -= 1
        t, h = later[waiting, 0], later[waiting, 1]
        row, share = _halve(chain, bodies, active, need, w, t, h)
        if row >= 0:
            return row, share
        if row == _NO_ROOM:
            for side in range(2):
                later[waiting, 0] = t + (0.5 if side == 0 else -0.5) * h
                later[waiting, 1] = 0.5 * h
                waiting += 1
    return -1, 0.0


@leaf_kernel
def _set_line(q_begin: Array, q_end: Array, w: Scratch) -> None:
    """Write the motion between two configurations into the queue."""
    curve = w.queue.curve
    for d in range(q_begin.shape[0]):
        curve[0, d], curve[1, d] = q_begin[d], q_end[d] - q_begin[d]
        curve[2, d] = curve[3, d] = 0.0


@leaf_kernel
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
    at_end = first_pair(chain, bodies, active, need, q_end, w)
    if at_end >= 0:
        return at_end, 1.0
    _set_line(q_begin, q_end, w)
    return _proven(chain, bodies, active, need, w)


@leaf_kernel
def motion_free(
    chain: Chain,
    bodies: Bodies,
    active: Flags,
    margin: float,
    q_begin: Array,
    q_end: Array,
    w: Scratch,
) -> bool:
    """Whether a straight joint motion is proven to be free; see :func:`motion_contact`."""
    need = bodies.clearance + margin
    if any_pair(chain, bodies, active, need, q_end, w) >= 0:
        return False
    _set_line(q_begin, q_end, w)
    return _proven(chain, bodies, active, need, w)[0] < 0


@leaf_kernel
def curve_contacts(
    chain: Chain,
    bodies: Bodies,
    active: Flags,
    margin: float,
    s: Array,
    q: Array,
    m_begin: Array,
    m_end: Array,
    w: Scratch,
    out: Indices,
) -> None:
    """Look for contact on each piece of a joint motion that is cubic from knot to knot.

    Args:
        chain: The chain.
        bodies: The bodies.
        active: Which pairs count, shape (m,).
        margin: Gap asked for on top of the clearance [m].
        s: Knots, shape (k + 1,), strictly increasing.
        q: Values at the knots, shape (k + 1, dof) [rad or m].
        m_begin: Derivatives by s at the begin of each piece, shape (k, dof).
        m_end: Derivatives at its end, shape (k, dof).
        w: Work space.
        out: Out: the row of a pair for each piece, as :func:`motion_contact` has it, -1 where the
            whole piece is proven to be free, shape (k,).
    """
    need, curve = bodies.clearance + margin, w.queue.curve
    for k in range(s.shape[0] - 1):
        h = s[k + 1] - s[k]
        for d in range(q.shape[1]):
            step, a, b = q[k + 1, d] - q[k, d], h * m_begin[k, d], h * m_end[k, d]
            curve[0, d], curve[1, d] = q[k, d], a
            curve[2, d], curve[3, d] = 3.0 * step - 2.0 * a - b, a + b - 2.0 * step
        out[k], _ = _proven(chain, bodies, active, need, w)
