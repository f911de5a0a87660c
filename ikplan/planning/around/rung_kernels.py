"""Steps from one rung of a path to the next that the arm can take, shortest first, compiled."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.collision.check import ContactArrays
from ikplan.collision.motion import motion_contact
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.workspace import Workspace, new_workspace
from ikplan.kinematics.target import Target
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.tracking.tracking_kernels import MIDPOINT_RATIO, NO_EXTRA_OFFSET

__all__ = ["follow_step", "join_rungs"]


@kernel
def follow_step(
    halves: tuple[ContactArrays, ContactArrays],
    target: Target,
    before: Array,
    after: Array,
    bounds: tuple[Array, Array],
    exact: float,
    middle: Array,
    w: Workspace,
) -> tuple[bool, int]:
    """Return whether the arm follows the path from one configuration to another, clear of contact.

    Args:
        halves: The arm and what must not be touched, in either half of the step.
        target: The target half-way.
        before: Where the step begins, shape (dof,) [rad or m].
        after: Where it ends, shape (dof,) [rad or m].
        bounds: Lower and upper position limits, shape (dof,) each [rad or m].
        exact: Error that counts as none [m and rad].
        middle: Out: the configuration half-way, shape (dof,) [rad or m].
        w: Work space.

    Returns:
        Whether it does, and evaluations.
    """
    first, second = halves
    dof = before.shape[0]
    step = 0.0
    for d in range(dof):
        middle[d] = 0.5 * (before[d] + after[d])
        step += (after[d] - before[d]) ** 2
    distance, angle, spent = refine(
        first.chain, target, middle, bounds[0], bounds[1], Effort(15, 8), w
    )
    if max(distance, angle) > exact:
        return False, spent
    off = 0.0
    for d in range(dof):
        off += (middle[d] - 0.5 * (before[d] + after[d])) ** 2
    if math.sqrt(off) > MIDPOINT_RATIO * math.sqrt(step) + NO_EXTRA_OFFSET:
        return False, spent
    row, _ = motion_contact(
        first.chain, first.bodies, first.active, first.margin, before, middle, first.scratch
    )
    if row < 0:
        row, _ = motion_contact(
            second.chain, second.bodies, second.active, second.margin, middle, after,
            second.scratch,
        )  # fmt: skip
    return row < 0, spent


@kernel
def join_rungs(
    halves: tuple[ContactArrays, ContactArrays],
    half_way: Targets,
    cost: Array,
    before: Array,
    after: Array,
    longest: float,
    tried: int,
    bounds: tuple[Array, Array],
    exact: float,
) -> tuple[Array, Indices, Array, int]:
    """Reach each candidate of a rung by the shortest way whose last step the arm can take.

    Args:
        halves: The arm and what must not be touched, in either half of the step.
        half_way: The target half-way, one.
        cost: Joint motion to each candidate of the rung before, inf where no way leads, shape (b,).
        before: Candidates of the rung before, shape (b, dof) [rad or m].
        after: Candidates of the rung, shape (c, dof) [rad or m].
        longest: How far a joint may move in a step [rad or m].
        tried: Steps to a candidate that are looked at, shortest way first.
        bounds: Lower and upper position limits, shape (dof,) each [rad or m].
        exact: Error that counts as none [m and rad].

    Returns:
        Joint motion to each candidate, inf where there is no way, shape (c,); the candidates before
        them, -1 where there is none, shape (c,); the configurations half-way, shape (c, dof) [rad
        or m]; and evaluations.
    """
    b, c, dof = before.shape[0], after.shape[0], after.shape[1]
    w = new_workspace(halves[0].chain)
    target = target_at(half_way, 0)
    reached, parent = np.full(c, np.inf), np.full(c, -1)
    middles, middle, total = np.zeros((c, dof)), np.empty(dof), np.empty(b)
    evaluations = 0
    for j in range(c):
        for i in range(b):
            length = widest = 0.0
            for d in range(dof):
                gap = after[j, d] - before[i, d]
                length += gap * gap
                widest = max(widest, abs(gap))
            total[i] = np.inf if widest > longest else cost[i] + math.sqrt(length)
        for _ in range(min(tried, b)):
            i = int(np.argmin(total))
            if total[i] == np.inf:
                break
            taken, spent = follow_step(
                halves, target, before[i], after[j], bounds, exact, middle, w
            )
            evaluations += spent
            if taken:
                reached[j], parent[j] = total[i], i
                middles[j] = middle
                break
            total[i] = np.inf
    return reached, parent, middles, evaluations
