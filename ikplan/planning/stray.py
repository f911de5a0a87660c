"""How far the joint spline through stations strays from the path between them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_batch
from ikplan.planning.candidates import Targets
from ikplan.planning.edges import excess_between, has_edges
from ikplan.planning.guide import Guide, nearest_places
from ikplan.planning.track import errors_at
from ikplan.request import Tolerance
from ikplan.timing import JointPath

__all__ = ["strayed_shares"]

Array = NDArray[np.float64]

_INSIDE = np.array([0.2, 0.5, 0.8])
_THROUGHOUT = np.array([0.0, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.97, 1.0])
"""Where in each step the tool is looked at, quickly and closely, as shares of the step. About a
sharp bend, and where it may cross an edge of what is free, the tool strays in a small part of a
step, and begins anywhere."""


def strayed_shares(
    chain: Chain,
    guide: Guide,
    targets_at: Callable[[Array], Targets],
    s: Array,
    path: JointPath,
    tolerance: Tolerance,
    enough: float,
) -> tuple[Array, int]:
    """Measure how much of the tolerance is used up between each two stations.

    Args:
        chain: The arm's chain.
        guide: The tool path.
        targets_at: Gives the targets at path positions.
        s: Path positions of the stations, shape (m,).
        path: The joint spline through the stations.
        tolerance: How far from the path the tool may be.
        enough: Share of the tolerance up to which it does not matter how much; where a quick look
            finds no more, a close one follows.

    Returns:
        Largest share of the tolerance used between each two stations, shape (m - 1,), and
        evaluations spent.
    """
    freedom = targets_at(s[:1]).freedom
    worst, evaluations = np.zeros(len(s) - 1), 0
    for shares in (_THROUGHOUT,) if has_edges(freedom) else (_INSIDE, _THROUGHOUT):
        worst = _look(chain, guide, targets_at, s, path, tolerance, enough, shares)
        evaluations += len(shares) * (len(s) - 1)
        if worst.max(initial=0.0) > enough:
            break
    return worst, evaluations


def _look(
    chain: Chain,
    guide: Guide,
    targets_at: Callable[[Array], Targets],
    s: Array,
    path: JointPath,
    tolerance: Tolerance,
    enough: float,
    shares: Array,
) -> Array:
    """Largest share of the tolerance used at some shares, shape (k,), of each step: (m - 1,)."""
    count = len(shares)
    knots = path.s_waypoints
    sigma = (knots[:-1, None] + np.diff(knots)[:, None] * shares).ravel()
    abreast = (s[:-1, None] + np.diff(s)[:, None] * shares).ravel()
    q = np.ascontiguousarray(path(sigma))
    R, p = forward_batch(chain, q)

    def used(places: Array) -> Array:
        targets = targets_at(places)
        off = _share(tolerance, *errors_at(chain, targets, q)).reshape(-1, count).max(axis=1)
        if has_edges(targets.freedom):
            off = np.maximum(off, _share(tolerance, *excess_between(targets, R, p, shares)))
        return np.asarray(off)

    low, high = np.repeat(s[:-1], count), np.repeat(s[1:], count)
    worst = used(nearest_places(guide, abreast, p, low, high))
    if worst.max(initial=0.0) > enough:
        # Nearest says little where the tool turns on the way, or is free to be beside the path.
        worst = np.minimum(worst, used(abreast))
    return worst


def _share(tolerance: Tolerance, distance: Array, angle: Array) -> Array:
    """Share of the tolerance that distances [m] and angles [rad] use up."""
    return np.maximum(distance / tolerance.position, angle / tolerance.orientation)
