"""The solution nearest to a start configuration, out of many seeds.

Every seed is refined; of the solutions, the nearest are slid along their self-motion to the point
nearest to the start. Sliding costs several times a refinement, and a solution that is far before
its slide is seldom the nearest after it.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.copying import copy_into
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.restarts import PATIENCE, nearest_turns, restart_into
from ikplan.ik.self_motion import nearest_on_manifold
from ikplan.ik.workspace import Workspace, new_workspace
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target
from ikplan.sorting import stable_order

__all__ = ["nearest_solutions"]


@kernel
def _distance(a: Array, b: Array) -> float:
    total = 0.0
    for k in range(a.shape[0]):
        total += (a[k] - b[k]) ** 2
    return math.sqrt(total)


@kernel
def _doubles(q: Array, rows: Array, count: int, apart: float) -> bool:
    """Whether one of the first rows is within ``apart`` of q in every joint."""
    for i in range(count):
        largest = 0.0
        for k in range(q.shape[0]):
            largest = max(largest, abs(rows[i, k] - q[k]))
        if largest < apart:
            return True
    return False


@kernel
def nearest_solutions(
    chain: Chain,
    target: Target,
    seeds: Array,
    spread: int,
    shift: float,
    q_start: Array,
    lower: Array,
    upper: Array,
    tolerance_position: float,
    tolerance_orientation: float,
    slides: int,
    solutions: Array,
    errors: Array,
) -> tuple[int, int]:
    """Refine seeds, slide the nearest solutions, drop the doubles.

    Args:
        chain: The chain from base to tool.
        target: The tool pose wanted.
        seeds: Seeds, shape (k, dof) [rad or m].
        spread: Number of further seeds, spread evenly over the bounds.
        shift: Shift of the spread seeds, in [0, 1).
        q_start: Configuration to be near to, shape (dof,) [rad or m].
        lower: Lower bounds, finite, shape (dof,) [rad or m].
        upper: Upper bounds, finite, shape (dof,) [rad or m].
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        slides: Solutions that are slid.
        solutions: Out: solutions, nearest first, at most ``slides``; with none, the best
            configuration in row 0, shape (slides, dof).
        errors: Out: distance [m], angle [rad] and joint distance of each, shape (slides, 3).

    Returns:
        Number of solutions, and evaluations spent.
    """
    w: Workspace = new_workspace(chain)
    total, dof = seeds.shape[0] + spread, seeds.shape[1]
    pool, lengths = np.empty((total, dof)), np.empty(total)
    q = np.empty(dof)
    count, evaluations, best = 0, 0, math.inf
    for s in range(total):
        if s < seeds.shape[0]:
            for k in range(dof):
                q[k] = min(max(seeds[s, k], lower[k]), upper[k])
        else:
            restart_into(s, shift, lower, upper, q)
            if s % 2 == 0:  # every other one nearer to the start, where the solution is wanted
                for k in range(dof):
                    q[k] = 0.5 * (q[k] + min(max(q_start[k], lower[k]), upper[k]))
        distance, angle, spent = refine(chain, target, q, lower, upper, Effort(40, PATIENCE), w)
        evaluations += spent
        if distance <= tolerance_position and angle <= tolerance_orientation:
            nearest_turns(chain, q, q_start, lower, upper)
            if not _doubles(q, pool, count, 1e-4):
                copy_into(pool[count], q)
                lengths[count] = _distance(q, q_start)
                count += 1
        elif count == 0 and distance * distance + angle * angle < best:
            best = distance * distance + angle * angle
            copy_into(solutions[0], q)
            errors[0, 0], errors[0, 1], errors[0, 2] = distance, angle, math.inf
    order = stable_order(lengths[:count])
    found = 0
    for j in range(min(count, slides)):
        copy_into(q, pool[order[j]])
        evaluations += nearest_on_manifold(chain, target, q, q_start, lower, upper, 60, w)
        distance, angle, spent = refine(chain, target, q, lower, upper, Effort(3, PATIENCE), w)
        evaluations += spent
        if _doubles(q, solutions, found, 1e-6):
            continue
        length = _distance(q, q_start)
        place = found
        while place > 0 and length < errors[place - 1, 2]:
            copy_into(solutions[place], solutions[place - 1])
            copy_into(errors[place], errors[place - 1])
            place -= 1
        copy_into(solutions[place], q)
        errors[place, 0], errors[place, 1], errors[place, 2] = distance, angle, length
        found += 1
    return found, evaluations
