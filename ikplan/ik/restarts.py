"""Full solves by refinement alone: Levenberg-Marquardt from the start, then from restarts.

Restarts come from a low-discrepancy sequence (Roberts' R_d), shifted by the seed, rather than from
a random generator: they cover the joint space evenly, and cost nothing to set up.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Flags
from ikplan.ik.levenberg_marquardt import Effort, Workspace, new_workspace, refine
from ikplan.ik.self_motion import nearest_on_manifold
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Freedom, Target

__all__ = ["PATIENCE", "lm_into", "nearest_turns", "restart_into", "solve_lm"]

PATIENCE = 6


@kernel
def restart_into(index: int, shift: float, lower: Array, upper: Array, q: Array) -> None:
    """Write restart ``index`` of the sequence, uniform over the limits, shape (dof,) [rad or m]."""
    steps = np.empty(q.shape[0])
    restart_steps(steps)
    restart_by_steps(index, shift, steps, lower, upper, q)


@leaf_kernel
def restart_steps(steps: Array) -> None:
    """Write the steps of the sequence in units of the range, shape (dof,)."""
    dof = steps.shape[0]
    # Root of x^(dof + 1) = x + 1: the golden ratio's kin in dof dimensions.
    root = 2.0
    for _ in range(32):
        root = (1.0 + root) ** (1.0 / (dof + 1.0))
    for k in range(dof):
        steps[k] = root ** (-(k + 1.0))


@leaf_kernel
def restart_by_steps(
    index: int, shift: float, steps: Array, lower: Array, upper: Array, q: Array
) -> None:
    """Write restart ``index`` of the sequence as :func:`restart_into` does, by its steps."""
    for k in range(q.shape[0]):
        u = (shift + (index + 1) * steps[k]) % 1.0
        q[k] = lower[k] + u * (upper[k] - lower[k])


@kernel
def nearest_turns(chain: Chain, q: Array, q_start: Array, lower: Array, upper: Array) -> None:
    """Replace each revolute joint value by its 2 pi copy nearest to the start inside the limits."""
    if chain.coupled:
        return
    turn = 2.0 * math.pi
    for k in range(q.shape[0]):
        if not chain.prismatic[k] and upper[k] - lower[k] >= turn:
            value = q[k] - turn * math.floor((q[k] - q_start[k]) / turn + 0.5)
            if lower[k] <= value <= upper[k]:
                q[k] = value


@kernel
def lm_into(
    chain: Chain,
    target: Target,
    q_start: Array,
    lower: Array,
    upper: Array,
    tolerance_position: float,
    tolerance_orientation: float,
    restarts: int,
    iterations: int,
    seed: int,
    slide: bool,
    q: Array,
    trial: Array,
    steps: Array,
    w: Workspace,
) -> tuple[float, float, int]:
    """Find one solution near the start; see :func:`solve_lm`.

    Args:
        chain: The chain from base to tool.
        target: The tool pose wanted.
        q_start: First seed, shape (dof,) [rad or m].
        lower: Lower bounds, finite, shape (dof,) [rad or m].
        upper: Upper bounds, finite, shape (dof,) [rad or m].
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        restarts: Number of further seeds.
        iterations: Largest number of steps from one seed.
        seed: Shifts the restart sequence.
        slide: Slide the solution along its self-motion to the point nearest to ``q_start``.
        q: Out: the solution, or the best configuration found, shape (dof,) [rad or m].
        trial: Buffer, shape (dof,).
        steps: Steps of the restart sequence, shape (dof,); zeros: to be written when one is needed.
        w: Buffers of the chain.

    Returns:
        Distance [m] and rotation angle [rad] from the target, and evaluations spent.
    """
    shift = (0.5 + seed * 0.6180339887498949) % 1.0
    best, best_distance, best_angle = math.inf, math.inf, math.inf
    evaluations = 0
    for attempt in range(restarts + 1):
        if attempt == 0:
            for k in range(q.shape[0]):
                trial[k] = min(max(q_start[k], lower[k]), upper[k])
        else:
            if steps[0] == 0.0:
                restart_steps(steps)
            restart_by_steps(attempt, shift, steps, lower, upper, trial)
        distance, angle, spent = refine(
            chain, target, trial, lower, upper, Effort(iterations, PATIENCE), w
        )
        evaluations += spent
        if distance * distance + angle * angle < best:
            best = distance * distance + angle * angle
            best_distance, best_angle = distance, angle
            for k in range(q.shape[0]):
                q[k] = trial[k]
        if distance <= tolerance_position and angle <= tolerance_orientation:
            break
    nearest_turns(chain, q, q_start, lower, upper)
    if slide and best_distance <= tolerance_position and best_angle <= tolerance_orientation:
        evaluations += nearest_on_manifold(chain, target, q, q_start, lower, upper, 60, w)
        best_distance, best_angle, spent = refine(
            chain, target, q, lower, upper, Effort(4, PATIENCE), w
        )
        evaluations += spent
    return best_distance, best_angle, evaluations


@kernel
def solve_lm(
    placements: Array,
    prismatic: Flags,
    coupled: bool,
    coupling: Array,
    offset: Array,
    R_target: Array,
    p_target: Array,
    oriented: bool,
    axis: int,
    cone: float,
    boxed: bool,
    box: Array,
    in_tool: bool,
    R_box: Array,
    q_start: Array,
    lower: Array,
    upper: Array,
    tolerance_position: float,
    tolerance_orientation: float,
    restarts: int,
    iterations: int,
    seed: int,
    slide: bool,
    q: Array,
) -> tuple[float, float, int]:
    """Find one solution near the start, else the best that any restart reached.

    Chain and target come field by field: numba takes far longer to unpack named tuples at the
    border with Python than this solve takes.

    Args:
        placements: Of the chain from base to tool.
        prismatic: Of the chain.
        coupled: Of the chain.
        coupling: Of the chain.
        offset: Of the chain.
        R_target: Rotation wanted, shape (3, 3).
        p_target: Position wanted, shape (3,) [m].
        oriented: Whether the rotation counts.
        axis: Of the target's freedom.
        cone: Of the target's freedom.
        boxed: Of the target's freedom.
        box: Of the target's freedom.
        in_tool: Of the target's freedom.
        R_box: Of the target's freedom.
        q_start: First seed, shape (dof,) [rad or m].
        lower: Lower bounds, finite, shape (dof,) [rad or m].
        upper: Upper bounds, finite, shape (dof,) [rad or m].
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        restarts: Number of further seeds.
        iterations: Largest number of steps from one seed.
        seed: Shifts the restart sequence.
        slide: Slide the solution along its self-motion to the point nearest to ``q_start``.
        q: Out: the solution, or the best configuration found, shape (dof,) [rad or m].

    Returns:
        Distance [m] and rotation angle [rad] from the target, and evaluations spent.
    """
    chain = Chain(placements, prismatic, coupled, coupling, offset)
    freedom = Freedom(axis, cone, boxed, box, in_tool, R_box)
    weight = ORIENTATION_WEIGHT if oriented else 0.0
    target = Target(R_target, p_target, oriented, weight, freedom)
    return lm_into(
        chain,
        target,
        q_start,
        lower,
        upper,
        tolerance_position,
        tolerance_orientation,
        restarts,
        iterations,
        seed,
        slide,
        q,
        np.empty(q.shape[0]),
        np.zeros(q.shape[0]),
        new_workspace(chain),
    )
