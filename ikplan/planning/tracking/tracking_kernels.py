"""Tracking a tool path continuously, point by point.

Two neighbouring configurations are joined only if the motion between them stays on the path: the
configuration half-way is brought onto the half-way target, and must not have to move far for it.
Where it has to, the points are too far apart, or lie on different branches. There is no threshold
on joint jumps.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.levenberg_marquardt import Effort, differentiate, refine, residual
from ikplan.ik.workspace import Workspace, new_workspace
from ikplan.kinematics.chain import Chain
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.ladder.null_space import null_space_basis

__all__ = [
    "LIMIT_MARGIN",
    "NO_EXTRA_OFFSET",
    "errors_at",
    "first_discontinuity",
    "project_onto_targets",
    "track_points",
]


_SINGULARITY_STEP = 0.02
"""How far to step aside from a singular configuration [rad or m]."""
LIMIT_MARGIN = 0.1
"""Share of a joint's range within which of a limit self-motion moves away from it."""
MIDPOINT_RATIO = 0.25
"""Fraction of a step by which the half-way configuration may be off the middle."""
NO_EXTRA_OFFSET = 1e-7
"""Extra midpoint offset treated as zero [rad or m]."""


@kernel
def _midpoint_is_continuous(
    chain: Chain,
    targets: Targets,
    k: int,
    before: Array,
    after: Array,
    lower: Array,
    upper: Array,
    tolerance: float,
    angle_tolerance: float,
    extra_offset: float,
    middle: Array,
    w: Workspace,
) -> tuple[bool, int]:
    """Solve point k, the middle of a step; return whether that is continuous, and evaluations."""
    dof = before.shape[0]
    step = 0.0
    for d in range(dof):
        middle[d] = 0.5 * (before[d] + after[d])
        step += (after[d] - before[d]) ** 2
    distance, angle, spent = refine(
        chain, target_at(targets, k), middle, lower, upper, Effort(8, 8), w
    )
    if distance > tolerance or angle > angle_tolerance:
        return False, spent
    off = 0.0
    for d in range(dof):
        off += (middle[d] - 0.5 * (before[d] + after[d])) ** 2
    return math.sqrt(off) <= MIDPOINT_RATIO * math.sqrt(step) + extra_offset, spent


@kernel
def _avoid_limits_in_null_space(
    chain: Chain, targets: Targets, k: int, q: Array, lower: Array, upper: Array, w: Workspace
) -> None:
    """Move q within its self-motion away from limits it comes near to, in place."""
    dof = q.shape[0]
    push = np.zeros(dof)
    near = False
    for d in range(dof):
        margin = LIMIT_MARGIN * (upper[d] - lower[d])
        if q[d] < lower[d] + margin:
            push[d] = lower[d] + margin - q[d]
            near = True
        elif q[d] > upper[d] - margin:
            push[d] = upper[d] - margin - q[d]
            near = True
    if not near:
        return
    target = target_at(targets, k)
    residual(chain, target, q, w.e, w)
    differentiate(chain, target, w)
    basis, fixed = np.zeros((dof, dof)), np.zeros(dof, dtype=np.bool_)
    rank = null_space_basis(w.Jt, fixed, basis)
    for i in range(rank):
        along = 0.0
        for d in range(dof):
            along += basis[i, d] * push[d]
        for d in range(dof):
            q[d] = min(max(q[d] + 0.2 * along * basis[i, d], lower[d]), upper[d])


@kernel
def _double_step(
    chain: Chain,
    targets: Targets,
    s: Array,
    q: Array,
    k: int,
    lower: Array,
    upper: Array,
    tolerance: float,
    angle_tolerance: float,
    avoid_limits: bool,
    moved: Array,
    aside: Array,
    trial: Array,
    w: Workspace,
) -> tuple[bool, int]:
    """Solve point k + 2 starting from point k; return success and evaluations.

    ``moved`` is how far the step before moved away from limits, as far as that does not carry on;
    how far this one does is written to ``aside``, shape (dof,) each [rad or m].
    """
    for d in range(trial.shape[0]):
        trial[d] = q[k, d]
        if k >= 2 and s[k] > s[k - 2]:
            # Straight on from the step before; damped, without what it moved away from limits: of
            # many small steps each adds to the speed of the self-motion.
            ahead = (s[k + 2] - s[k]) / (s[k] - s[k - 2])
            trial[d] += min(ahead, 2.0) * (q[k, d] - q[k - 2, d] - moved[d])
        trial[d] = min(max(trial[d], lower[d]), upper[d])
        aside[d] = -trial[d]
    if avoid_limits:
        _avoid_limits_in_null_space(chain, targets, k + 2, trial, lower, upper, w)
    for d in range(trial.shape[0]):
        aside[d] += trial[d]
    target = target_at(targets, k + 2)
    distance, angle, evaluations = refine(chain, target, trial, lower, upper, Effort(15, 8), w)
    for side in range(2):
        if distance <= tolerance and angle <= angle_tolerance:
            break
        # A singular configuration has no slope towards the target: step aside from it.
        for d in range(trial.shape[0]):
            step = _SINGULARITY_STEP if (d + side) % 2 == 0 else -_SINGULARITY_STEP
            trial[d] = min(max(q[k, d] + step, lower[d]), upper[d])
        distance, angle, spent = refine(chain, target, trial, lower, upper, Effort(25, 8), w)
        evaluations += spent
    return distance <= tolerance and angle <= angle_tolerance, evaluations


@kernel
def track_points(
    chain: Chain,
    targets: Targets,
    s: Array,
    q: Array,
    first: int,
    lower: Array,
    upper: Array,
    tolerance: float,
    angle_tolerance: float,
    redundant: bool,
    extra_offset: float,
    damped: bool,
) -> tuple[int, int]:
    """Track points from point ``first``, whose configuration is given, in steps of two.

    Args:
        chain: The chain from base to tool.
        targets: The targets of m points, m odd.
        s: Path positions of the points, shape (m,).
        q: In: rows up to ``first``, out: the rows after it as far as tracked, shape (m, dof).
        first: An even index.
        lower: Lower bounds, shape (dof,) [rad or m].
        upper: Upper bounds, shape (dof,) [rad or m].
        tolerance: Distance that counts as on the target [m].
        angle_tolerance: Angle that counts as on the target [rad].
        redundant: Whether the arm has self-motion to move away from its limits with.
        extra_offset: How far off the middle a half-way configuration may be besides its part of
            the step [rad or m]: in a bend sharper than the points are dense it is off by all of a
            step.
        damped: Whether self-motion away from limits does not carry on in the steps that follow.

    Returns:
        Index of the last point reached (even; the last one: all), and evaluations.
    """
    m, dof = q.shape
    w = new_workspace(chain)
    trial, middle = np.empty(dof), np.empty(dof)
    moved, aside = np.zeros(dof), np.empty(dof)
    evaluations = 0
    k = first
    while k + 2 < m:
        # Where moving away from limits fails, as by a singular configuration: without.
        for avoid_limits in range(2 if redundant else 1):
            reached, spent = _double_step(
                chain,
                targets,
                s,
                q,
                k,
                lower,
                upper,
                tolerance,
                angle_tolerance,
                redundant and avoid_limits == 0,
                moved,
                aside,
                trial,
                w,
            )
            evaluations += spent
            if reached:
                reached, spent = _midpoint_is_continuous(
                    chain,
                    targets,
                    k + 1,
                    q[k],
                    trial,
                    lower,
                    upper,
                    tolerance,
                    angle_tolerance,
                    extra_offset,
                    middle,
                    w,
                )
                evaluations += spent
            if reached:
                break
        if not reached:
            return k, evaluations
        q[k + 1] = middle
        q[k + 2] = trial
        if damped:
            moved[:] = aside
        k += 2
    return k, evaluations


@kernel
def first_discontinuity(
    chain: Chain,
    targets: Targets,
    q: Array,
    lower: Array,
    upper: Array,
    tolerance: float,
    angle_tolerance: float,
) -> tuple[int, int]:
    """Return the first even point whose step of two is not continuous, else m - 1; evaluations.

    Args:
        chain: The chain from base to tool.
        targets: The targets of m points, m odd.
        q: Configurations of the points, shape (m, dof) [rad or m].
        lower: Lower bounds, shape (dof,) [rad or m].
        upper: Upper bounds, shape (dof,) [rad or m].
        tolerance: Distance that counts as on the target [m].
        angle_tolerance: Angle that counts as on the target [rad].
    """
    m, dof = q.shape
    w = new_workspace(chain)
    middle = np.empty(dof)
    evaluations = 0
    for k in range(0, m - 2, 2):
        continuous, spent = _midpoint_is_continuous(
            chain,
            targets,
            k + 1,
            q[k],
            q[k + 2],
            lower,
            upper,
            tolerance,
            angle_tolerance,
            NO_EXTRA_OFFSET,
            middle,
            w,
        )
        evaluations += spent
        if not continuous:
            return k, evaluations
    return m - 1, evaluations


@kernel
def project_onto_targets(
    chain: Chain, targets: Targets, q: Array, lower: Array, upper: Array
) -> tuple[Array, int]:
    """Bring each configuration onto its target, in place.

    Returns:
        The larger of distance [m] and angle [rad] left of each, shape (m,), and evaluations.
    """
    m = q.shape[0]
    w = new_workspace(chain)
    left = np.empty(m)
    evaluations = 0
    for k in range(m):
        distance, angle, spent = refine(
            chain, target_at(targets, k), q[k], lower, upper, Effort(15, 8), w
        )
        left[k] = max(distance, angle)
        evaluations += spent
    return left, evaluations


@kernel
def errors_at(chain: Chain, targets: Targets, q: Array) -> tuple[Array, Array]:
    """Return distance [m] and angle [rad] of each configuration from its target, shape (m,)."""
    m = q.shape[0]
    w = new_workspace(chain)
    distance, angle = np.empty(m), np.empty(m)
    for k in range(m):
        distance[k], angle[k], _ = residual(chain, target_at(targets, k), q[k], w.e, w)
    return distance, angle
