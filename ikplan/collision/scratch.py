"""Work space of the checks for contact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.collision.bodies import Bodies
from ikplan.kinematics.chain import Chain

__all__ = ["Queue", "Scratch", "new_scratch"]

_INTERVALS = 256
"""Intervals that are looked at together at most."""
_OPEN = 8
"""How often every pair may be open in them."""
_WAITING = 128
"""More intervals than can wait: a motion is never halved so often."""


class Queue(NamedTuple):
    """Intervals of a motion that are still to be looked at.

    Attributes:
        middle: Middle of each interval, as a share of the motion, shape (k,).
        half: Half of its length, shape (k,).
        begin: First of its open pairs in ``rows``, shape (k,).
        end: Last of them (exclusive), shape (k,).
        rows: Open pairs of all intervals.
        later: Middle and half length of intervals that are looked at when these are done, shape
            (l, 2).
        reach: How far each serial joint moves from the middle of an interval, shape (n,).
        speed: How far it moves at its speed in the middle, shape (n,).
        turn: Most of its acceleration times the square of half the interval, shape (n,).
        step: The three of each joint value, shape (3, dof).
        q: The configuration in the middle, shape (dof,).
        curve: Coefficients of the motion by its share, lowest power first, shape (4, dof).
    """

    middle: Array
    half: Array
    begin: Indices
    end: Indices
    rows: Indices
    later: Array
    reach: Array
    speed: Array
    turn: Array
    step: Array
    q: Array
    curve: Array


class Scratch(NamedTuple):
    """Work space of the kernels; the axes are carried over from one configuration to the next.

    Attributes:
        R: Rotations of the links, shape (n + 1, 3, 3).
        p: Origins of the links, shape (n + 1, 3) [m].
        centre: Centres of the pieces in the base, shape (k, 3) [m].
        ends: Both ends of the capsules' axes in the base, shape (k, 6) [m].
        spheres: Centres of the covering spheres in the base, shape (s, 3) [m].
        box: Axes and centre of the boxes in the base, shape (k, 12) [m].
        placed: When the rest of each piece was placed last, shape (k,).
        now: Shape (1,): a number for the configuration that the links are at.
        moved: When the motion of each piece was bounded last, shape (k,).
        motion: How far each piece can move against each link, shape (k, n + 1) [m].
        bend: How far from a straight line at a constant speed, shape (k, n + 1) [m].
        spin: How far each link turns at its speed in the middle, shape (n + 1, 3) [rad].
        moment: What that moves its points is ``spin x point - moment``, shape (n + 1, 3) [m].
        sweep: How the outer piece of a pair moves against the inner one, shape (9,): at its centre
            and how it turns at its speed, its radius, its bend, and how far it moves at most.
        still: The same of a pair that does not move.
        last: Shape (1,): the pair that was in contact last, -1 at first.
        axis: Separating axis of each pair when it was last looked at, shape (m, 3).
        work: For the distance of two pieces, shape (12, 3).
        queue: For the proof of a motion.
    """

    R: Array
    p: Array
    centre: Array
    ends: Array
    spheres: Array
    box: Array
    placed: Indices
    now: Indices
    moved: Indices
    motion: Array
    bend: Array
    spin: Array
    moment: Array
    sweep: Array
    still: Array
    last: Indices
    axis: Array
    work: Array
    queue: Queue


@kernel
def _new_queue(chain: Chain, bodies: Bodies, dof: int) -> Queue:
    """Return a queue with room for some intervals."""
    n = chain.prismatic.shape[0]
    return Queue(
        np.zeros(_INTERVALS),
        np.zeros(_INTERVALS),
        np.zeros(_INTERVALS, dtype=np.int64),
        np.zeros(_INTERVALS, dtype=np.int64),
        np.zeros(_OPEN * bodies.pairs.shape[0], dtype=np.int64),
        np.zeros((_WAITING, 2)),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((3, dof)),
        np.zeros(dof),
        np.zeros((4, dof)),
    )


@kernel
def new_scratch(chain: Chain, bodies: Bodies) -> Scratch:
    """Return work space for a chain and its bodies."""
    n = chain.prismatic.shape[0] + 1
    return Scratch(
        np.zeros((n, 3, 3)),
        np.zeros((n, 3)),
        bodies.centre.copy(),  # what stands is there already
        np.zeros((bodies.radius.shape[0], 6)),
        np.zeros((bodies.spheres.shape[0], 3)),
        np.zeros((bodies.radius.shape[0], 12)),
        np.zeros(bodies.radius.shape[0], dtype=np.int64),
        np.zeros(1, dtype=np.int64),
        np.zeros(bodies.radius.shape[0], dtype=np.int64),
        np.zeros((bodies.radius.shape[0], n)),
        np.zeros((bodies.radius.shape[0], n)),
        np.zeros((n, 3)),
        np.zeros((n, 3)),
        np.zeros(9),
        np.zeros(9),
        np.full(1, -1, dtype=np.int64),
        np.zeros((bodies.pairs.shape[0], 3)),
        np.zeros((12, 3)),
        _new_queue(chain, bodies, chain.coupling.shape[1]),
    )
