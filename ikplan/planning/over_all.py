"""Ways of a redundant arm along a path, chosen over all its stations at once.

Led along a path from its start, an arm takes the nearest configuration at each step, and may come
to a limit that it would have kept clear of had it begun to move aside long before.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ikplan.kinematics.arm import Arm
from ikplan.planning.candidates import Targets, grow_candidates
from ikplan.planning.clock import Clock
from ikplan.planning.ladder import distinct_paths
from ikplan.planning.polish import polish

__all__ = ["chosen_over_all"]

Array = NDArray[np.float64]

_CAP, _FIRST, _FRESH = 40, 100, 4
"""Candidates kept of a station; seeds of the first station, and of every further one."""
_PATHS = 6
"""Paths over the ladder that are polished."""
_EXACT = 1e-9
"""Error that counts as none [m and rad]."""


def chosen_over_all(
    arm: Arm, targets: Targets, q_start: Array, clock: Clock
) -> tuple[list[tuple[float, Array]], int]:
    """Choose ways through every station that move the joints little.

    Whether the arm can move from each station to the next along the path is not looked at.

    Args:
        arm: The arm.
        targets: The targets of m stations.
        q_start: The configuration at the first, shape (dof,) [rad or m].
        clock: The time budget.

    Returns:
        Joint motion [rad or m] and configurations, shape (m, dof), of each way, shortest first,
        none where a station has no solution; and evaluations spent.
    """
    clock.check()
    after = Targets(
        targets.R[1:], targets.p[1:], targets.oriented[1:], targets.weight[1:], targets.freedom
    )
    candidates = grow_candidates(
        arm.chain, after, np.empty((len(after.p), 0, arm.dof)), q_start, arm.lower, arm.upper,
        _CAP, _FIRST, _FRESH, 0.5, _EXACT,
    )  # fmt: skip
    evaluations = int(candidates.evaluations[0])
    if (candidates.counts == 0).any():
        return [], evaluations
    ways = []
    for q in distinct_paths(
        arm.chain, candidates, q_start, False, arm.lower, arm.upper, _PATHS, 0.6, 0.1
    ):
        clock.check()
        length, spent = polish(
            arm.chain, after, q, q_start, False, arm.lower, arm.upper, 60, 1e-5
        )  # fmt: skip
        evaluations += spent
        ways.append((length, np.ascontiguousarray(np.vstack([q_start, q]))))
    return sorted(ways, key=lambda way: way[0]), evaluations
