"""Every branch that a tool path may begin in."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.kinematics.target import fixed_rows
from ikplan.planning.ladder.equivalent_configurations import with_equivalents
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.ladder.motion_cost import posture_distances
from ikplan.planning.tracking.start_copies import distinct_modulo_turns
from ikplan.planning.waypoints.free_solutions import free_solutions
from ikplan.planning.waypoints.past_limits import solutions_at_limits
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.waypoints.waypoint_ik import solve_waypoint
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["branches", "further_branches"]


_STARTS = 24
"""Starts of a tool path that are tried where it may begin in any branch."""
_SEEDS = 150
_FURTHER = 48
"""Starts that are tried where those tried first do not do."""
_EFFORT = 16
"""How many times as many solutions these are chosen from."""
_APART = 1e-6
"""Solutions nearer to each other than this are one [rad or m]."""
_FAR = 1.0
"""Where every solution moves a joint by more than this, those at limits are looked at too
[rad or m]."""


def branches(problem: WaypointProblem, *, turns: bool = False, effort: int = 1) -> Array:
    """Return solutions of a single target, nearest to the start first.

    Args:
        problem: A problem of one target.
        turns: Whether full turns of a solution are solutions too; otherwise each is at its copy
            nearest to the start.
        effort: How many times as many are looked for.

    Returns:
        Solutions, shape (c, dof), c >= 1 [rad or m].

    Raises:
        Unreachable: There is none within tolerance.
        InCollision: All that were found are in contact.
    """
    arm = problem.solver.arm
    with problem.clock.stage("ik"):
        found = sample_ik_solutions(
            arm.chain,
            stack_targets(problem.targets),
            np.empty((1, 0, arm.dof)),
            problem.q_start,
            arm.lower,
            arm.upper,
            2 * effort * _STARTS,
            effort * _SEEDS,
            0,
            (0.5 + problem.solver.seed * 0.6180339887498949) % 1.0,
            1e-9,
            arm.closed_form,
        )
        problem.clock.count(int(found.evaluations[0]))
        q = found.q[0, : found.counts[0]]
        q = with_equivalents(arm, q) if turns else distinct_modulo_turns(arm, q)
        if len(q) == 0:
            q = solve_waypoint(problem, 0, problem.q_start)[None]
        moves = np.abs(q - problem.q_start).max(axis=1)
        target = problem.targets[0]
        exact = arm.dof == fixed_rows(target.freedom, target.oriented)
        fixed = not problem.start_free and exact
        if fixed and moves.min() > _FAR:
            q = np.vstack([q, *solutions_at_limits(problem, stack_targets(problem.targets))])
        if problem.contact is not None:
            free = problem.contact.free(q, problem.segment(0))
            q = q[free] if free.any() else free_solutions(problem, 0, problem.q_start)
    away = np.linalg.norm(problem.cost.weights * (q - problem.q_start), axis=1)
    order = np.argsort(away + posture_distances(q, problem.cost), kind="stable")
    return np.ascontiguousarray(q[order[: effort * _STARTS]])


def further_branches(problem: WaypointProblem, tried: Array) -> Array:
    """Return solutions of a single target far from those tried, and from each other.

    The solutions of a redundant arm are a continuum; the nearest ones show where its branches are,
    but not how far one of them leads.

    Args:
        problem: A problem of one target.
        tried: Its solutions tried before, shape (k, dof), k >= 1 [rad or m].

    Returns:
        Solutions, shape (c, dof) [rad or m]: each the farthest from all before it.

    Raises:
        Unreachable: There is none within tolerance.
        InCollision: All that were found are in contact.
    """
    every = branches(problem, effort=_EFFORT)
    away = np.abs(every[:, None] - tried).max(axis=2).min(axis=1)
    chosen: list[int] = []
    while len(chosen) < _FURTHER and away.max() > _APART:
        chosen.append(int(np.argmax(away)))
        away = np.minimum(away, np.abs(every - every[chosen[-1]]).max(axis=1))
    return np.ascontiguousarray(every[chosen])
