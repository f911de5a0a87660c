"""Joint sequences of a redundant arm along a path, chosen over all its points at once.

Tracking a path from its start, an arm takes the nearest configuration at each step, and may come
to a limit that it would have kept clear of had it begun to move aside long before.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.kinematics.arm import Arm
from ikplan.planning.ladder.free_candidates import keep_free
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.ladder.motion_cost import MotionCost
from ikplan.planning.ladder.shortest_sequences import ik_candidates, shortened_sequences
from ikplan.time_budget import TimeBudget

__all__ = ["resolve_redundancy_globally"]


def resolve_redundancy_globally(
    arm: Arm,
    targets: Targets,
    q_start: Array,
    cost: MotionCost,
    clock: TimeBudget,
    free: Callable[[Array], Flags] | None = None,
) -> list[tuple[float, Array]]:
    """Choose sequences through every point that move the joints little.

    Whether the arm can move from each point to the next along the path is not looked at.

    Args:
        arm: The arm.
        targets: The targets of m points.
        q_start: The configuration at the first, shape (dof,) [rad or m].
        cost: What a sequence costs.
        clock: The time budget.
        free: Tells which configurations are free of contact; None: all are.

    Returns:
        Cost [rad or m] and configurations, shape (m, dof), of each sequence, shortest
        first; none where a point has no solution.
    """
    after = Targets(
        targets.R[1:], targets.p[1:], targets.oriented[1:], targets.weight[1:], targets.freedom
    )
    with clock.stage("ik"):
        candidates = ik_candidates(arm, after, q_start, clock)
    sequences: list[tuple[float, Array]] = []
    if free is not None:
        keep_free(candidates, free)
    if (candidates.counts == 0).any():
        return sequences
    for length, q in shortened_sequences(arm, after, candidates, q_start, False, cost, clock):
        clock.check()
        sequences.append((length, np.ascontiguousarray(np.vstack([q_start, q]))))
    return sorted(sequences, key=lambda sequence: sequence[0])
