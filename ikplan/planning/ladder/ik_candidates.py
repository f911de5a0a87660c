"""For each waypoint a diverse set of solutions.

Seeds are the solutions of the waypoint before (which follow their branch), the members of a
metaheuristic's last population, and points spread evenly over the joint space (which find new
branches, and new places on the self-motion manifold of a redundant arm). Each is refined, brought
to the 2 pi copy nearest to the start, and kept unless it doubles another. Where the arm has a
closed form, and the waypoint fixes the whole pose, its branches are taken instead, unless it is
singular.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.copying import copy_into
from ikplan.ik.closed_form import closed_form_solutions, has_closed_form
from ikplan.ik.levenberg_marquardt import Effort, Workspace, new_workspace, refine
from ikplan.ik.restarts import nearest_turns, restart_into
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.closed_form.branches import MOST_BRANCHES
from ikplan.kinematics.closed_form.form import NO_FORM, WITHOUT_FORM, ClosedForm
from ikplan.kinematics.target import Freedom, Target, constraint_rows

__all__ = ["IkCandidates", "Targets", "sample_ik_solutions", "target_at"]


_FAR = 0.6
"""Where every solution moves a joint by more than this on the way to the next waypoint, the ones
found there are no guide to all there are [rad or m]."""


class Targets(NamedTuple):
    """The targets of a path as arrays.

    Attributes:
        R: Rotations wanted in the base, shape (n, 3, 3).
        p: Positions wanted in the base, shape (n, 3) [m].
        oriented: Whether the rotation counts, shape (n,).
        weight: What one radian weighs against one metre, shape (n,) [m/rad].
        freedom: What need not hold at any of them.
    """

    R: Array
    p: Array
    oriented: Flags
    weight: Array
    freedom: Freedom


class _Branches(NamedTuple):
    """Solutions of each waypoint in closed form.

    Attributes:
        q: Branches, shape (n, 8, dof) [rad or m]; without a closed form (n, 0, dof).
        counts: How many each waypoint has, shape (n,).
        complete: Whether these are surely all, shape (n,).
        evaluations: Forward-kinematics evaluations spent, shape (n,).
    """

    q: Array
    counts: Indices
    complete: Flags
    evaluations: Indices


class IkCandidates(NamedTuple):
    """Solutions of each waypoint.

    Attributes:
        q: Solutions, shape (n, max_solutions, dof) [rad or m].
        counts: How many each waypoint has, shape (n,).
        evaluations: Forward-kinematics evaluations spent, shape (1,).
    """

    q: Array
    counts: Indices
    evaluations: Indices


@kernel
def target_at(targets: Targets, k: int) -> Target:
    """Return target k."""
    return Target(
        targets.R[k], targets.p[k], targets.oriented[k], targets.weight[k], targets.freedom
    )


@kernel
def _apart(a: Array, b: Array) -> float:
    """Return the largest difference of a joint."""
    apart = 0.0
    for k in range(a.shape[0]):
        apart = max(apart, abs(a[k] - b[k]))
    return apart


@kernel
def _keep(q: Array, spacing: float, row: Array, count: int) -> int:
    """Add q to the solutions of a waypoint unless one is nearer than ``spacing``; the new count."""
    if count == row.shape[0]:
        return count
    for i in range(count):
        if _apart(row[i], q) < spacing:
            return count
    copy_into(row[count], q)
    return count + 1


@kernel
def _take(branches: Array, count: int, found: IkCandidates, k: int) -> None:
    """Make branches the solutions of waypoint k: those that follow the ones before come first."""
    row = found.q[k]
    kept = 0
    left = np.ones(count, dtype=np.bool_)
    for s in range(found.counts[k - 1] if k > 0 else 0):
        nearest, best = -1, np.inf
        for i in range(count):
            if left[i]:
                apart = _apart(branches[i], found.q[k - 1, s])
                if apart < best:
                    nearest, best = i, apart
        if nearest >= 0 and kept < row.shape[0]:
            left[nearest] = False
            kept = _keep(branches[nearest], 1e-4, row, kept)
    for i in range(count):
        if left[i]:
            kept = _keep(branches[i], 1e-4, row, kept)
    found.counts[k] = kept


@kernel
def _branches_of(
    chain: Chain,
    form: ClosedForm,
    targets: Targets,
    q_start: Array,
    lower: Array,
    upper: Array,
    tolerance: float,
) -> _Branches:
    """Find the branches of every waypoint that fixes the whole pose."""
    n = targets.p.shape[0]
    found = _Branches(
        np.empty((n, MOST_BRANCHES, q_start.shape[0])),
        np.zeros(n, dtype=np.int64),
        np.zeros(n, dtype=np.bool_),
        np.zeros(n, dtype=np.int64),
    )
    w: Workspace = new_workspace(chain)
    for k in range(n):
        target = target_at(targets, k)
        if has_closed_form(form, target):
            found.counts[k], found.complete[k], found.evaluations[k] = closed_form_solutions(
                chain, form, target, q_start, lower, upper, tolerance, found.q[k], w
            )
    return found


@kernel
def _sample(
    chain: Chain,
    targets: Targets,
    exact: _Branches,
    seeds: Array,
    q_start: Array,
    lower: Array,
    upper: Array,
    max_solutions: int,
    initial_seeds: int,
    seeds_per_target: int,
    sequence_offset: float,
    tolerance: float,
) -> IkCandidates:
    """Find solutions of every waypoint, see :func:`sample_ik_solutions`."""
    n, dof = targets.p.shape[0], q_start.shape[0]
    found = IkCandidates(
        np.empty((n, max_solutions, dof)), np.zeros(n, dtype=np.int64), np.zeros(1, dtype=np.int64)
    )
    w: Workspace = new_workspace(chain)
    q = np.empty(dof)
    spread_lower, spread_upper = lower.copy(), upper.copy()
    for d in range(dof):
        if not math.isfinite(upper[d] - lower[d]):
            spread_lower[d], spread_upper[d] = q_start[d] - math.pi, q_start[d] + math.pi
    spread = 0
    for k in range(n):
        target = target_at(targets, k)
        branches, branch_count = exact.q[k], exact.counts[k]
        found.evaluations[0] += exact.evaluations[k]
        if exact.complete[k] and branch_count > 0:
            _take(branches, branch_count, found, k)
            continue
        redundant = dof > constraint_rows(target)
        spacing = 0.08 if redundant else 1e-4
        before = found.counts[k - 1] if k > 0 else 0
        given = before + 1 + seeds.shape[1] + branch_count
        count, nearest = 0, np.inf
        most = max(initial_seeds, seeds_per_target)
        for s in range(given + most):
            fresh = seeds_per_target if nearest <= _FAR else most
            full = count == max_solutions and (s >= before or nearest <= _FAR)
            if full or s == given + fresh:
                # The waypoints after have the same spread seeds whether or not this one is full.
                spread += given + fresh - max(s, given)
                break
            if s < before:
                copy_into(q, found.q[k - 1, s])
            elif s == before:
                copy_into(q, q_start)
            elif s < given - branch_count:
                copy_into(q, seeds[k, s - before - 1])
            elif s < given:
                copy_into(q, branches[s - given + branch_count])
            else:
                restart_into(spread, sequence_offset, spread_lower, spread_upper, q)
                spread += 1
            distance, angle, spent = refine(chain, target, q, lower, upper, Effort(25, 5), w)
            found.evaluations[0] += spent
            if distance <= tolerance and angle <= tolerance:
                if s < before:
                    nearest = min(nearest, _apart(q, found.q[k - 1, s]))
                nearest_turns(chain, q, q_start, lower, upper)
                count = _keep(q, spacing, found.q[k], count)
        found.counts[k] = count
    return found


def sample_ik_solutions(
    chain: Chain,
    targets: Targets,
    seeds: Array,
    q_start: Array,
    lower: Array,
    upper: Array,
    max_solutions: int,
    initial_seeds: int,
    seeds_per_target: int,
    sequence_offset: float,
    tolerance: float,
    form: ClosedForm = WITHOUT_FORM,
) -> IkCandidates:
    """Find solutions of every waypoint.

    Args:
        chain: The chain from base to tool, with dof joint values.
        targets: The n targets.
        seeds: Further seeds of each waypoint, shape (n, k, dof) [rad or m].
        q_start: Configuration to be near to, shape (dof,) [rad or m].
        lower: Lower position limits, -inf for a joint without, shape (dof,) [rad or m].
        upper: Upper position limits, inf for a joint without, shape (dof,) [rad or m].
        max_solutions: Most solutions kept of a waypoint.
        initial_seeds: Evenly spread seeds of the first waypoint, and of one far from the one
            before.
        seeds_per_target: Evenly spread seeds of every other waypoint.
        sequence_offset: Shift of the spread seeds, in [0, 1).
        tolerance: Error that counts as solved [m and rad].
        form: The closed form of the chain.

    Returns:
        The solutions, each joint at its 2 pi copy nearest to the start; those that follow the ones
        before come first, in their order.
    """
    if form.kind == NO_FORM:  # and nothing of the closed forms is compiled
        n, none = len(targets.p), np.zeros(len(targets.p), dtype=np.int64)
        exact = _Branches(np.empty((n, 0, len(q_start))), none, none != 0, none)
    else:
        exact = _branches_of(chain, form, targets, q_start, lower, upper, tolerance)
    found: IkCandidates = _sample(
        chain,
        targets,
        exact,
        seeds,
        q_start,
        lower,
        upper,
        max_solutions,
        initial_seeds,
        seeds_per_target,
        sequence_offset,
        tolerance,
    )
    return found
