"""Where the search for the way of a move takes its samples, and how it measures distances."""

from __future__ import annotations

import math

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.bodies import Bodies
from ikplan.collision.check import ContactArrays
from ikplan.kinematics.chain import Chain
from ikplan.planning.moves.connect import SearchSpace

__all__ = ["joint_weights", "search_space"]


def joint_weights(chain: Chain, bodies: Bodies) -> Array:
    """Return the weight of each joint value in the metric of the search, shape (dof,).

    It is the square root of the farthest that a unit of it can move a point of any body, by the
    lengths between the joints, over that of the joint which moves one farthest: what moves little
    may turn far in one step.
    """
    n = len(chain.prismatic)
    links = np.linalg.norm(chain.placements[:, 9:], axis=1).tolist()
    farthest = np.zeros(n + 1)
    moving = np.flatnonzero(bodies.carrier)
    outermost = np.linalg.norm(bodies.centre[moving], axis=1) + bodies.bound[moving]
    np.maximum.at(farthest, bodies.carrier[moving], outermost)
    own = np.zeros(n)
    for joint in range(n):
        length = 0.0
        for carrier in range(joint + 1, n + 1):
            if farthest[carrier] > 0.0:
                own[joint] = max(own[joint], length + farthest[carrier])
            length += links[carrier]
        if chain.prismatic[joint]:
            own[joint] = 1.0
    reach = np.abs(chain.coupling).T @ own if chain.coupled else own
    longest = float(reach.max())
    # A joint that moves no body still has to come to its goal.
    share = np.maximum(reach / longest, 1e-3) if longest > 0.0 else np.ones_like(reach)
    return np.asarray(np.sqrt(share))


def search_space(
    arrays: ContactArrays, lower: Array, upper: Array, q_start: Array, goals: Array
) -> SearchSpace:
    """Return the space of a search: half a turn about the start, as far as the limits allow.

    Args:
        arrays: What must not be touched.
        lower: Lower position limits, shape (dof,), may be -inf [rad or m].
        upper: Upper position limits, shape (dof,), may be inf [rad or m].
        q_start: The start, shape (dof,) [rad or m].
        goals: The goals, shape (g, dof), which are inside too [rad or m].
    """
    ends = np.vstack([q_start, goals])
    return SearchSpace(
        arrays.chain,
        arrays.bodies,
        arrays.active,
        arrays.margin,
        np.minimum(np.maximum(lower, q_start - math.pi), ends.min(axis=0)),
        np.maximum(np.minimum(upper, q_start + math.pi), ends.max(axis=0)),
        joint_weights(arrays.chain, arrays.bodies),
    )
