"""How far the joint spline through stations strays from the path between them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ikplan.documents.plan_request import Tolerance
from ikplan.joint_path import JointPath
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_batch
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.reference_path import ReferencePath, nearest_places
from ikplan.planning.tracking.tolerance_bounds import box_size, has_bounds, violation_between
from ikplan.planning.tracking.tracking_kernels import errors_at

__all__ = ["deviation_ratios"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_INSIDE = np.array([0.2, 0.5, 0.8])
_THROUGHOUT = np.array([0.0, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.97, 1.0])
"""Where in each step the tool is looked at, quickly and closely, as shares of the step. About a
sharp bend, and where it may cross an edge of what is free, the tool strays in a small part of a
step, and begins anywhere."""
_CLOSELY = np.linspace(0.0, 1.0, 49)
"""Where the tool is looked at in a step whose path is longer than the way of the tool."""
_SEEN = 0.8
"""Share of the tolerance from which on a part of the path counts as left out."""


def deviation_ratios(
    chain: Chain,
    guide: ReferencePath,
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
    for shares in (_THROUGHOUT,) if has_bounds(freedom) else (_INSIDE, _THROUGHOUT):
        worst = _look(chain, guide, targets_at, s, path, tolerance, enough, shares)
        evaluations += len(shares) * (len(s) - 1)
        if worst.max(initial=0.0) > enough:
            break
    return worst, evaluations


def _look(
    chain: Chain,
    guide: ReferencePath,
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
        if has_bounds(targets.freedom):
            off = np.maximum(off, _share(tolerance, *violation_between(targets, R, p, shares)))
        return np.asarray(off)

    low, high = np.repeat(s[:-1], count), np.repeat(s[1:], count)
    worst = used(nearest_places(guide, abreast, p, low, high))
    if worst.max(initial=0.0) > enough:
        # Nearest says little where the tool turns on the way, or is free to be beside the path.
        worst = np.minimum(worst, used(abreast))
    if count == len(_THROUGHOUT):
        moves = np.diff(p.reshape(-1, count, 3), axis=1)
        way = np.linalg.norm(moves, axis=2).sum(axis=1)
        longer = np.flatnonzero(np.diff(s) > way + tolerance.position)
        missed = _left_out(chain, targets_at, s, path, tolerance, longer)
        worst[longer] = np.maximum(worst[longer], missed)
    return worst


def _left_out(
    chain: Chain,
    targets_at: Callable[[Array], Targets],
    s: Array,
    path: JointPath,
    tolerance: Tolerance,
    steps: Index,
) -> Array:
    """Share of the tolerance by which the tool leaves out the part of a step it misses most.

    The nearest place of the path says nothing of it: where two parts of a fine curve are near one
    another, the tool goes over from one to the other and never up to the crest between them.

    Args:
        chain: The arm's chain.
        targets_at: Gives the targets at path positions.
        s: Path positions of the stations, shape (m,).
        path: The joint spline through the stations.
        tolerance: How far from the path the tool may be.
        steps: Steps whose path is longer than the way of the tool, shape (n,).

    Returns:
        Shares, shape (n,); 0 where the tool misses less than it may.
    """
    shares = np.zeros(len(steps))
    knots = path.s_waypoints
    for row, k in enumerate(steps):
        q = path(knots[k] + (knots[k + 1] - knots[k]) * _CLOSELY)
        _, tool = forward_batch(chain, np.ascontiguousarray(q))
        targets = targets_at(s[k] + (s[k + 1] - s[k]) * _CLOSELY)
        begin, along = tool[:-1], np.diff(tool, axis=0)
        from_begin = targets.p[:, None] - begin
        square = np.maximum((along * along).sum(axis=1), 1e-300)
        at = np.clip((from_begin * along).sum(axis=2) / square, 0.0, 1.0)
        off = np.linalg.norm(from_begin - at[:, :, None] * along, axis=2).min(axis=1).max()
        # The tool moves on curves between the places looked at: by about that they bulge.
        bulge = 0.2 * float(np.linalg.norm(np.diff(along, axis=0), axis=1).max())
        share = (off - box_size(targets.freedom) - bulge) / tolerance.position
        shares[row] = share if share > _SEEN else 0.0
    return shares


def _share(tolerance: Tolerance, distance: Array, angle: Array) -> Array:
    """Share of the tolerance that distances [m] and angles [rad] use up."""
    return np.maximum(distance / tolerance.position, angle / tolerance.orientation)
