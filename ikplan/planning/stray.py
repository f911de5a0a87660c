"""How far the joint spline through stations strays from the path between them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_batch
from ikplan.kinematics.target import Freedom
from ikplan.planning.candidates import Targets
from ikplan.planning.edges import excess_between, has_edges
from ikplan.planning.guide import Guide, nearest_places
from ikplan.planning.track import errors_at
from ikplan.request import Tolerance
from ikplan.timing import JointPath

__all__ = ["measured_shares", "strayed_shares"]

Array = NDArray[np.float64]

_INSIDE = np.array([0.2, 0.5, 0.8])
_THROUGHOUT = np.array([0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0])
"""The same where the tool may cross an edge of what is free: it does so in a small part of a step,
and begins anywhere."""


def measured_shares(freedom: Freedom) -> Array:
    """Where in each step the tool is measured, shape (k,), as shares of the step."""
    return _THROUGHOUT if has_edges(freedom) else _INSIDE


def strayed_shares(
    chain: Chain,
    guide: Guide,
    targets_at: Callable[[Array], Targets],
    s: Array,
    path: JointPath,
    tolerance: Tolerance,
) -> Array:
    """Return the largest share of the tolerance used between each two stations, shape (m - 1,).

    Args:
        chain: The arm's chain.
        guide: The tool path.
        targets_at: Gives the targets at path positions.
        s: Path positions of the stations, shape (m,).
        path: The joint spline through the stations.
        tolerance: How far from the path the tool may be.
    """
    freedom = targets_at(s[:1]).freedom
    shares = measured_shares(freedom)
    count = len(shares)
    knots = path.s_waypoints
    sigma = (knots[:-1, None] + np.diff(knots)[:, None] * shares).ravel()
    near = (s[:-1, None] + np.diff(s)[:, None] * shares).ravel()
    q = np.ascontiguousarray(path(sigma))
    R, p = forward_batch(chain, q)
    low, high = np.repeat(s[:-1], count), np.repeat(s[1:], count)
    targets = targets_at(nearest_places(guide, near, p, low, high))
    distance, angle = errors_at(chain, targets, q)
    off = np.maximum(distance / tolerance.position, angle / tolerance.orientation)
    worst = off.reshape(-1, count).max(axis=1)
    if has_edges(freedom):
        distance, angle = excess_between(targets, R, p, shares)
        off = np.maximum(distance / tolerance.position, angle / tolerance.orientation)
        worst = np.maximum(worst, off)
    return np.asarray(worst)
