"""Whether configurations are free of contact, compiled."""

from __future__ import annotations

import math

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.collision.bodies import Bodies
from ikplan.collision.pair_gaps import (
    bounded_gap,
    pair_gap,
    place_pieces,
    sphere_gap,
    spheres_meet,
)
from ikplan.collision.scratch import Scratch
from ikplan.kinematics.chain import Chain

__all__ = ["any_pair", "contacts", "first_pair", "gaps"]


@leaf_kernel
def _near(bodies: Bodies, row: int, need: float, w: Scratch) -> bool:
    """Whether the gap of a pair is not larger than needed."""
    i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
    if not spheres_meet(bodies, i, j, need, w) or bounded_gap(bodies, i, j, need, w) > need:
        return False
    return not pair_gap(bodies, row, need, need, w)[0] > need


@leaf_kernel
def _first_near(bodies: Bodies, active: Flags, need: float, w: Scratch) -> int:
    """Return the first pair of the placed pieces whose gap is not larger than needed, or -1."""
    k, part, last_part = 0, 0, 0
    while part < last_part or k < bodies.tops.shape[0]:
        if part < last_part:
            row = part
            part += 1
        else:
            row = bodies.tops[k]
            k += 1
            if not active[row]:
                continue
        i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
        if not spheres_meet(bodies, i, j, need, w) or bounded_gap(bodies, i, j, need, w) > need:
            continue
        if bodies.parts[row, 1] > 0:
            part, last_part = bodies.parts[row, 0], bodies.parts[row, 1]
        elif not pair_gap(bodies, row, need, need, w)[0] > need:
            return row
    return -1


@leaf_kernel
def first_pair(
    chain: Chain, bodies: Bodies, active: Flags, need: float, q: Array, w: Scratch
) -> int:
    """Return the first pair whose gap is not larger than needed, -1 where there is none."""
    place_pieces(chain, bodies, q, w)
    return _first_near(bodies, active, need, w)


@leaf_kernel
def any_pair(chain: Chain, bodies: Bodies, active: Flags, need: float, q: Array, w: Scratch) -> int:
    """Return a pair whose gap is not larger than needed, -1 where there is none.

    What was in contact last is looked at first.
    """
    place_pieces(chain, bodies, q, w)
    last = w.last[0]
    if last >= 0 and active[last] and _near(bodies, last, need, w):
        return int(last)
    row = _first_near(bodies, active, need, w)
    if row >= 0:
        w.last[0] = row
    return row


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
        out[c] = first_pair(chain, bodies, active, bodies.clearance + margin, q[c], w)


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
        out: Out: a lower bound of the gap of each pair, infinite of whole bodies whose parts are
            looked at, shape (m,) [m].

    Returns:
        The row of the smallest, -1 where there is none.
    """
    place_pieces(chain, bodies, q, w)
    least, at = math.inf, -1
    for row in range(bodies.pairs.shape[0]):
        out[row] = math.inf
        if not active[row] or bodies.parts[row, 1] > 0:
            continue
        i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
        out[row] = sphere_gap(bodies, i, j, w)
        if out[row] <= most:
            out[row] = pair_gap(bodies, row, most, math.nan, w)[0]  # to the end: no gap is enough
        if out[row] < least:
            least, at = out[row], row
    return at
