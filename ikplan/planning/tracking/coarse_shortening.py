"""Shortening of long sequences: first every so many points, then all.

A Newton step moves every point by a little only, so that a motion of the whole sequence takes many
of them; where few points stand for all, few and cheap ones. It also leads past minima that are
there only because the points are close.
"""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.kinematics.arm import Arm
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.ladder.motion_cost import MotionCost, sequence_cost
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.planning.tracking.tracked_arm import EXACT
from ikplan.planning.tracking.tracking_kernels import project_onto_targets

__all__ = ["shortened", "shortened_coarse_first"]

_FINEST, _COARSER, _FEWEST = 2, 4, 16
"""Of every 2nd, 8th, 32nd ... point; of 16 points at least."""
_ITERATIONS = 30
_GAIN = 1e-4
"""Steps of shortening at most, and the least share of the motion that one has to save."""


def shortened(
    arm: Arm, targets: Targets, q: Array, q_start: Array, cost: MotionCost
) -> tuple[Array, int]:
    """Return a sequence after a start made shorter by self-motion, and the evaluations spent.

    Args:
        arm: The arm.
        targets: The n targets.
        q: Their configurations, shape (n, dof) [rad or m].
        q_start: The start, shape (dof,) [rad or m].
        cost: What a motion costs.
    """
    shorter = q.copy()
    _, spent = shorten_sequence(
        arm.chain, targets, shorter, q_start, False, arm.lower, arm.upper, cost, _ITERATIONS, _GAIN
    )
    return shorter, spent


def shortened_coarse_first(
    arm: Arm, targets: Targets, q: Array, q_start: Array, cost: MotionCost
) -> tuple[Array, int]:
    """Return a sequence made shorter as by :func:`shortened`, by fewer and fewer points left out.

    What few points move by the points between them move in proportion, and then back onto their
    targets. It counts where the whole is shorter then.

    Args:
        arm: As in :func:`shortened`.
        targets: As there.
        q: As there.
        q_start: As there.
        cost: As there.
    """
    n, evaluations = len(q), 0
    stride = _FINEST
    while n >= _FEWEST * _COARSER * stride:
        stride *= _COARSER
    while stride > 1:
        some = np.arange((n - 1) % stride, n, stride)
        few = np.ascontiguousarray(q[some])
        moved, spent = shortened(arm, _chosen(targets, some), few, q_start, cost)
        evaluations += spent
        at = np.append(-1, some)
        moves = np.vstack([np.zeros_like(q_start), moved - few])
        columns = [np.interp(np.arange(n), at, column) for column in moves.T]
        every = np.clip(q + np.stack(columns, axis=1), arm.lower, arm.upper)
        left, spent = project_onto_targets(arm.chain, targets, every, arm.lower, arm.upper)
        evaluations += spent
        before, after = (sequence_cost(rows, q_start, False, cost) for rows in (q, every))
        if left.max() <= EXACT and after < before:
            q = every
        stride //= _COARSER
    shorter, spent = shortened(arm, targets, q, q_start, cost)
    return shorter, evaluations + spent


def _chosen(targets: Targets, rows: Indices) -> Targets:
    """Return some of the targets."""
    return Targets(
        np.ascontiguousarray(targets.R[rows]),
        np.ascontiguousarray(targets.p[rows]),
        targets.oriented[rows],
        targets.weight[rows],
        targets.freedom,
    )
