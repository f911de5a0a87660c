"""How far the tool deviates from its path on the joint spline between two points."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ikplan.arrays import Array, Indices, steps_of
from ikplan.documents.poses import Tolerance
from ikplan.joint_path import JointPath
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_batch
from ikplan.path.tolerance_shares import left_to_tracking
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.left_out_kernels import farthest_from_way
from ikplan.planning.tracking.reference_path import ReferencePath, nearest_positions
from ikplan.planning.tracking.tolerance_bounds import box_size, has_bounds, violation_between
from ikplan.planning.tracking.tracking_kernels import errors_at

__all__ = ["deviation_ratios"]


_INSIDE = np.array([0.2, 0.5, 0.8])
_THROUGHOUT = np.array([0.0, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.97, 1.0])
"""Where in each step the tool is looked at, quickly and closely, as shares of the step. About a
sharp bend, and where it may cross an edge of what is free, the tool deviates in a small part of a
step, and begins anywhere."""
_CLOSELY = np.linspace(0.0, 1.0, 49)
"""Where the tool is looked at in a step whose path is longer than the way of the tool."""
_TOGETHER = 256
"""Steps that are looked at closely at once."""
_SEEN = 0.8
"""Ratio to what is left of the tolerance from which on a part of the path counts as left out."""


def deviation_ratios(
    chain: Chain,
    reference: ReferencePath,
    targets_at: Callable[[Array], Targets],
    s: Array,
    path: JointPath,
    tolerance: Tolerance,
    enough: float,
    *,
    bounded: bool,
    steps: Indices | None = None,
) -> tuple[Array, int]:
    """Measure which part of the tolerance the deviation takes in steps between two points.

    Args:
        chain: The arm's chain.
        reference: The tool path.
        targets_at: Gives the targets at path positions.
        s: Path positions of the points, shape (m,).
        path: The joint spline through the points.
        tolerance: How far from the path the tool may be.
        enough: Ratio up to which it does not matter how much; where a quick look
            finds no more, a close one follows.
        bounded: Whether what is free has an edge that the tool can cross; a close look is the first
            then.
        steps: Steps, by the point that each begins at, shape (n,), of which the first look is
            enough; None: all, as closely as it takes.

    Returns:
        Largest ratio of deviation to tolerance in each of the steps, shape (n,), and evaluations
        spent.
    """
    looks = (_THROUGHOUT,) if bounded else (_INSIDE, _THROUGHOUT)
    if steps is None:
        steps = np.arange(len(s) - 1)
    else:
        looks = looks[:1]
    worst, evaluations = np.zeros(len(steps)), 0
    for shares in looks:
        worst = _sample_deviation(
            chain, reference, targets_at, s, path, tolerance, enough, shares, steps
        )
        evaluations += len(shares) * len(steps)
        if worst.max(initial=0.0) > enough:
            break
    return worst, evaluations


def _sample_deviation(
    chain: Chain,
    reference: ReferencePath,
    targets_at: Callable[[Array], Targets],
    s: Array,
    path: JointPath,
    tolerance: Tolerance,
    enough: float,
    shares: Array,
    steps: Indices,
) -> Array:
    """Largest ratio of deviation to tolerance at shares, shape (k,), of some steps, (n,): (n,)."""
    count = len(shares)
    s_points = path.s_waypoints
    size = steps_of(s)[steps]
    sigma = (s_points[steps, None] + steps_of(s_points)[steps, None] * shares).ravel()
    abreast = (s[steps, None] + size[:, None] * shares).ravel()
    q = np.ascontiguousarray(path(sigma))
    R, p = forward_batch(chain, q)

    def ratios_at(positions: Array) -> Array:
        targets = targets_at(positions)
        off = _ratio(tolerance, *errors_at(chain, targets, q)).reshape(-1, count).max(axis=1)
        if has_bounds(targets.freedom):
            off = np.maximum(off, _ratio(tolerance, *violation_between(targets, R, p, shares)))
        return np.asarray(off)

    low, high = np.repeat(s[steps], count), np.repeat(s[steps + 1], count)
    worst = ratios_at(nearest_positions(reference, abreast, p, low, high))
    if worst.max(initial=0.0) > enough:
        # Nearest says little where the tool turns on the way, or is free to be beside the path.
        worst = np.minimum(worst, ratios_at(abreast))
    if count == len(_THROUGHOUT):
        places = p.reshape(-1, count, 3)
        moves = places[:, 1:] - places[:, :-1]
        way = np.linalg.norm(moves, axis=2).sum(axis=1)
        longer = np.flatnonzero(size > way + tolerance.position)
        seen = _SEEN * left_to_tracking(reference.taken)
        missed = _left_out(chain, targets_at, s, path, tolerance, steps[longer], seen)
        worst[longer] = np.maximum(worst[longer], missed)
    return worst


def _left_out(
    chain: Chain,
    targets_at: Callable[[Array], Targets],
    s: Array,
    path: JointPath,
    tolerance: Tolerance,
    steps: Indices,
    seen: float,
) -> Array:
    """Ratio to the tolerance of what the tool leaves out of a step, where it misses it most.

    The nearest place of the path says nothing of it: where two parts of a fine curve are near one
    another, the tool goes over from one to the other and never up to the crest between them.

    Args:
        chain: The arm's chain.
        targets_at: Gives the targets at path positions.
        s: Path positions of the points, shape (m,).
        path: The joint spline through the points.
        tolerance: How far from the path the tool may be.
        steps: Steps whose path is longer than the way of the tool, shape (n,).
        seen: Ratio from which on a part counts as left out.

    Returns:
        Ratios, shape (n,); 0 where the tool misses less than it may.
    """
    ratios, count = np.zeros(len(steps)), len(_CLOSELY)
    s_points = path.s_waypoints
    for first in range(0, len(steps), _TOGETHER):
        rows = slice(first, first + _TOGETHER)
        k = steps[rows]
        q = path((s_points[k, None] + (s_points[k + 1] - s_points[k])[:, None] * _CLOSELY).ravel())
        _, tool = forward_batch(chain, np.ascontiguousarray(q))
        targets = targets_at((s[k, None] + (s[k + 1] - s[k])[:, None] * _CLOSELY).ravel())
        off, change = farthest_from_way(tool.reshape(-1, count, 3), targets.p.reshape(-1, count, 3))
        # The tool moves on curves between the places looked at: by about that they bulge.
        ratio = (off - box_size(targets.freedom) - 0.2 * change) / tolerance.position
        ratios[rows] = np.where(ratio > seen, ratio, 0.0)
    return ratios


def _ratio(tolerance: Tolerance, distance: Array, angle: Array) -> Array:
    """Ratio of distances [m] and angles [rad] to the tolerance, the larger of both."""
    return np.maximum(distance / tolerance.position, angle / tolerance.orientation)
