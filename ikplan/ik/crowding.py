"""How crowded a configuration is by bodies, and that as a term of what the searches minimise.

As in the papers on obstacle avoidance by metaheuristics, the term is a penalty by distance beside
the error of the pose. Distances of bodies cost many times the error (about 10 us against 0.4),
so that they are looked at only where the pose is nearly met; the term fades in from there.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Flags
from ikplan.collision.bodies import Bodies
from ikplan.collision.check import ContactArrays
from ikplan.collision.pair_gaps import bounded_gap, pair_gap, place_pieces, spheres_meet
from ikplan.collision.scratch import Scratch
from ikplan.kinematics.chain import Chain

__all__ = [
    "NEAR",
    "REACH",
    "WEIGHT",
    "Surroundings",
    "crowding",
    "crowding_of_rows",
    "crowding_term",
    "surroundings",
]

REACH = 0.1
"""Gap beyond the clearance from which on two bodies no longer count [m]."""
NEAR = 0.4
"""Error of the pose from which on distances are not looked at, as a distance of the tool [m].

Some searches, such as PSO, stall at an error of 0.1 to 0.2 (0.1 a unit of Delta R): below that the
term would never act in them.
"""
WEIGHT = 0.3
"""The largest value of the term, as a distance of the tool [m].

The crowding falls by at most 6.5 per metre of gap, so that close to a body the minimum may lie some
millimetres off the pose; the refinement takes that away.
"""


class Surroundings(NamedTuple):
    """What a configuration is to keep clear of.

    Attributes:
        chain: The chain of the arm.
        bodies: Bodies to be kept apart.
        active: Which pairs of their pieces count, shape (m,).
        scratch: Work space.
        least: Gap that counts as contact [m].
        reach: Gap beyond that one from which on two bodies no longer count [m].
        near: Value of the pose's error from which on the term is its weight.
        weight: Largest value of the term.
    """

    chain: Chain
    bodies: Bodies
    active: Flags
    scratch: Scratch
    least: float
    reach: float
    near: float
    weight: float


def surroundings(
    arrays: ContactArrays, *, reach: float = REACH, near: float = NEAR, weight: float = WEIGHT
) -> Surroundings:
    """Return what the kernels here take.

    Args:
        arrays: The bodies, as a check for contact has them.
        reach: Gap beyond the clearance from which on two bodies no longer count [m].
        near: Error of the pose from which on distances are not looked at.
        weight: Largest value of the term.
    """
    least = arrays.bodies.clearance + arrays.margin
    return Surroundings(
        arrays.chain, arrays.bodies, arrays.active, arrays.scratch, least, reach, near, weight
    )


@leaf_kernel
def crowding(around: Surroundings, q: Array) -> float:
    """Return how crowded a configuration is, from 0 to 1.

    1 where two bodies are nearer than allowed. Else ``t / (1 + t)``, where t is the sum over the
    pairs of bodies of ``max(0, 1 - (gap - least) / reach)^2``: a pair that stays near whatever the
    joints do, such as two links of a wrist, adds a constant and hides no other.

    Args:
        around: What to keep clear of.
        q: Joint values, shape (dof,) [rad or m].
    """
    bodies, w = around.bodies, around.scratch
    place_pieces(around.chain, bodies, q, w)
    far = around.least + around.reach
    total, nearest = 0.0, far
    k, part, last_part = 0, 0, 0
    while part < last_part or k < bodies.tops.shape[0]:
        if part < last_part:
            row = part
            part += 1
        else:
            total += ((far - nearest) / around.reach) ** 2
            nearest = far
            row = bodies.tops[k]
            k += 1
            if not around.active[row]:
                continue
        i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
        if not spheres_meet(bodies, i, j, nearest, w):
            continue
        if bounded_gap(bodies, i, j, nearest, w) > nearest:
            continue
        if bodies.parts[row, 1] > 0:
            part, last_part = bodies.parts[row, 0], bodies.parts[row, 1]
            continue
        gap = pair_gap(bodies, row, nearest, math.nan, w)[0]  # to the end: no gap is enough
        if gap < nearest:
            if not gap > around.least:
                return 1.0
            nearest = gap
    total += ((far - nearest) / around.reach) ** 2
    return float(total / (1.0 + total))


@leaf_kernel
def crowding_of_rows(around: Surroundings, q: Array, out: Array) -> None:
    """Write how crowded configurations are, see :func:`crowding`.

    Args:
        around: What to keep clear of.
        q: Configurations, shape (c, dof) [rad or m].
        out: Out: shape (c,).
    """
    for c in range(q.shape[0]):
        out[c] = crowding(around, q[c])


@leaf_kernel
def crowding_term(around: Surroundings | None, q: Array, value: float) -> float:
    """Return the term of a configuration beside the error of its pose.

    ``weight (1 - u (1 - crowding))`` with ``u = 1 - value / near``; where the error is ``near`` or
    more, the whole weight, without a look at the bodies. The objective is as continuous as the
    crowding, and still grows with the error.

    Args:
        around: What to keep clear of; None: nothing, the term is 0.
        q: Joint values, shape (dof,) [rad or m].
        value: Error of the pose.
    """
    if around is None:
        return 0.0
    if value >= around.near:
        return around.weight
    met = 1.0 - value / around.near
    return float(around.weight * (1.0 - met * (1.0 - crowding(around, q))))
