"""Poses, one or many, in one call of a kernel, each as :func:`ikplan.ik.restarts.solve_lm` does.

No pose has an influence on another: the answer to one is the same in any batch.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags
from ikplan.ik.restarts import lm_into
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Freedom, Target, pose_defect

__all__ = ["solve_lm_batch", "solve_lm_pose"]


@kernel
def solve_lm_batch(
    chain: Chain,
    freedom: Freedom,
    R: Array,
    p: Array,
    oriented: bool,
    q_start: Array,
    lower: Array,
    upper: Array,
    tolerance_position: float,
    tolerance_orientation: float,
    restarts: int,
    iterations: int,
    seed: int,
    q: Array,
    errors: Array,
) -> None:
    """Find a solution of each pose near its start, else the best that any restart reached.

    Args:
        chain: The chain from base to tool.
        freedom: No freedom.
        R: Rotations wanted, shape (n, 3, 3), or (1, 3, 3) where none counts.
        p: Positions wanted, shape (n, 3) [m].
        oriented: Whether the rotations count.
        q_start: First seeds, shape (n, dof), or (1, dof) for all [rad or m].
        lower: Lower bounds, finite, of the same shape as ``q_start`` [rad or m].
        upper: Upper bounds, finite, of the same shape as ``q_start`` [rad or m].
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        restarts: Number of further seeds of each pose.
        iterations: Largest number of steps from one seed.
        seed: Shifts the restart sequence.
        q: Out: solutions, or the best configurations found, shape (n, dof) [rad or m].
        errors: Out: distance [m], rotation angle [rad] and evaluations of each, shape (n, 3).
    """
    w = new_workspace(chain)
    trial, steps = np.empty(q.shape[1]), np.zeros(q.shape[1])
    weight = ORIENTATION_WEIGHT if oriented else 0.0
    for k in range(p.shape[0]):
        turned = k if oriented else 0
        start = k if q_start.shape[0] > 1 else 0
        target = Target(R[turned], p[k], oriented, weight, freedom)
        distance, angle, spent = lm_into(
            chain,
            target,
            q_start[start],
            lower[start],
            upper[start],
            tolerance_position,
            tolerance_orientation,
            restarts,
            iterations,
            seed,
            False,
            q[k],
            trial,
            steps,
            w,
        )
        errors[k, 0], errors[k, 1], errors[k, 2] = distance, angle, spent


@kernel
def solve_lm_pose(
    placements: Array,
    prismatic: Flags,
    coupled: bool,
    coupling: Array,
    offset: Array,
    T: Array,
    q_start: Array,
    lower: Array,
    upper: Array,
    tolerance_position: float,
    tolerance_orientation: float,
    restarts: int,
    iterations: int,
    seed: int,
    q: Array,
) -> tuple[float, float, float, int]:
    """Find a solution of one pose near the start.

    Half of the time of such a solve would be that of its call: so few arguments are passed, and
    the chain comes field by field.

    Args:
        placements: Of the chain from base to tool.
        prismatic: Of the chain.
        coupled: Of the chain.
        coupling: Of the chain.
        offset: Of the chain.
        T: Tool pose wanted, homogeneous, shape (4, 4), in any layout.
        q_start: First seed, shape (dof,) [rad or m].
        lower: Lower bounds, finite, shape (dof,) [rad or m].
        upper: Upper bounds, finite, shape (dof,) [rad or m].
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        restarts: Number of further seeds.
        iterations: Largest number of steps from one seed.
        seed: Shifts the restart sequence.
        q: Out: the solution, shape (dof,) [rad or m].

    Returns:
        Distance [m], rotation angle [rad] and joint distance from the start [rad or m] of the
        solution, and evaluations spent. Infinities: T is no pose to rounding, or none was found.
    """
    R, p = np.empty((3, 3)), np.empty(3)
    for i in range(3):
        p[i] = T[i, 3]
        for j in range(3):
            R[i, j] = T[i, j]
    if not pose_defect(R, p) <= 1e-13:
        return math.inf, math.inf, math.inf, 0
    chain = Chain(placements, prismatic, coupled, coupling, offset)
    none = Freedom(-1, 0.0, False, p, False, R)
    target = Target(R, p, True, ORIENTATION_WEIGHT, none)
    distance, angle, evaluations = lm_into(
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
        False,
        q,
        np.empty(q.shape[0]),
        np.zeros(q.shape[0]),
        new_workspace(chain),
    )
    if distance > tolerance_position or angle > tolerance_orientation:
        return math.inf, math.inf, math.inf, 0
    squared = 0.0
    for k in range(q.shape[0]):
        squared += (q[k] - q_start[k]) ** 2
    return distance, angle, math.sqrt(squared), evaluations
