"""How far the tool leaves what a target leaves free, between the places where it is looked at.

Path points often lie on the very edge of a cone or a box. From there a joint spline may lead out
and back in within a small share of the step, and what is left over once the freedom is taken off
shows
nothing of it at a place beyond. The lean, or the offset along an axis of the box, is smooth there:
a parabola through three places tells how far it goes between them.
"""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, lengths_of
from ikplan.kinematics.target import Freedom
from ikplan.path.rotation.so3 import log
from ikplan.planning.ladder.ik_candidates import Targets

__all__ = ["box_size", "has_bounds", "violation_between"]


def has_bounds(freedom: Freedom) -> bool:
    """Whether a freedom has an edge that the tool can cross: a cone or a box."""
    return freedom.boxed or freedom.cone > 0.0


def box_size(freedom: Freedom) -> float:
    """Distance from the middle of a box to its corner [m]; 0: there is no box."""
    return float(np.linalg.norm(freedom.box[:3])) if freedom.boxed else 0.0


def violation_between(targets: Targets, R: Array, p: Array, shares: Array) -> tuple[Array, Array]:
    """Measure how far outside cone and box the tool comes in each step.

    Args:
        targets: Targets at k places of each of n steps, n k of them, step by step.
        R: Rotations of the tool in the base there, shape (n k, 3, 3).
        p: Positions of the tool in the base there, shape (n k, 3) [m].
        shares: Where in each step the places are, shape (k,), k >= 3, increasing.

    Returns:
        Largest distance [m] and angle [rad] outside, each of shape (n,); 0 for what is without
        edge, and for the angle of steps that ask for no orientation.
    """
    freedom, k = targets.freedom, len(shares)
    n = len(p) // k
    distance, angle = np.zeros(n), np.zeros(n)
    axes = targets.R if freedom.in_tool else np.broadcast_to(freedom.R_box, R.shape)
    if freedom.boxed:
        along = np.einsum("mji,mj->mi", axes, p - targets.p)
        distance = _outside(along.reshape(n, k, 3), freedom.box[:3], shares)
    if freedom.axis >= 0:
        if freedom.cone > 0.0:
            a, b = R[:, :, freedom.axis], targets.R[:, :, freedom.axis]
            sine = lengths_of(np.cross(a, b))
            lean = np.arctan2(sine, np.einsum("mi,mi->m", a, b))
            angle = _outside(lean.reshape(n, k, 1), np.array([freedom.cone]), shares)
    elif freedom.boxed:
        turn = log(R @ np.swapaxes(targets.R, 1, 2))
        along = np.einsum("mji,mj->mi", axes, turn)
        angle = _outside(along.reshape(n, k, 3), freedom.box[3:], shares)
    return distance, np.where(targets.oriented.reshape(n, k).all(axis=1), angle, 0.0)


def _outside(values: Array, most: Array, shares: Array) -> Array:
    """Norm of what the peaks of values, shape (n, k, c), have over most, shape (c,): shape (n,)."""
    peak = np.maximum(_highest(values, shares), _highest(-values, shares))
    return lengths_of(np.maximum(peak - most, 0.0))


def _highest(values: Array, shares: Array) -> Array:
    """Highest of values, shape (n, k, c), and of the parabolas through each three: (n, c)."""
    highest = values.max(axis=1)
    for i in range(len(shares) - 2):
        u, v = shares[i + 1] - shares[i], shares[i + 2] - shares[i]
        y = values[:, i]
        # y + slope x + bend x^2 through the three.
        first, second = (values[:, i + 1] - y) / u, (values[:, i + 2] - y) / v
        bend = (second - first) / (v - u)
        slope = first - bend * u
        top = np.where(bend < 0.0, -0.5 * slope / np.where(bend < 0.0, bend, -1.0), 0.0)
        inside = (top > 0.0) & (top < v)
        highest = np.where(inside, np.maximum(highest, y + 0.5 * slope * top), highest)
    return np.asarray(highest)
