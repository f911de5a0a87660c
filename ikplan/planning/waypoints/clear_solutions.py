"""Solutions of one waypoint that keep clear of bodies."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.check import ContactCheck
from ikplan.ik.crowding import crowding_of_rows, surroundings
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.waypoints.free_solutions import free_solutions
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["clearest_solution", "crowding_at"]

_CAP = 200
_SEEDS = 150


def crowding_at(contact: ContactCheck, q: Array, segment: int | None = None) -> Array:
    """Return how crowded configurations are, from 0 to 1 where bodies touch, shape (c,).

    Args:
        contact: The check for contact, which has the bodies.
        q: Configurations, shape (c, dof) [rad or m].
        segment: The segment they belong to; None: every body is there.
    """
    out = np.empty(len(q))
    crowding_of_rows(surroundings(contact.arrays(segment)), np.ascontiguousarray(q), out)
    return out


def clearest_solution(problem: WaypointProblem, k: int, q_near: Array, nearest: Array) -> Array:
    """Return the least crowded solution found of a waypoint, shape (dof,) [rad or m].

    Looked at are the one that is nearest, those that the last population of the search leads to,
    and those of evenly spread seeds; of equally crowded ones the nearest is returned.

    Args:
        problem: The targets, and a check for contact.
        k: Index of the waypoint.
        q_near: Where it should be near to, shape (dof,) [rad or m].
        nearest: The nearest solution, in contact or not, shape (dof,) [rad or m].

    Raises:
        InCollision: All that were found are in contact.
    """
    contact, solver = problem.contact, problem.solver
    assert contact is not None
    arm, segment = solver.arm, problem.segment(k)
    seeds = np.empty((0, arm.dof))
    if solver.searcher is not None:
        lower, upper = arm.search_bounds(q_near)
        seeds, spent = solver.searcher.seeds(problem.targets[k], q_near, lower, upper)
        problem.clock.count(spent)
    found = sample_ik_solutions(
        arm.chain,
        stack_targets(problem.targets[k : k + 1]),
        seeds[None],
        q_near,
        arm.lower,
        arm.upper,
        _CAP,
        _SEEDS,
        0,
        (0.5 + solver.seed * 0.6180339887498949) % 1.0,
        1e-9,
        arm.closed_form,
    )
    problem.clock.count(int(found.evaluations[0]))
    q = np.vstack([nearest, found.q[0, : found.counts[0]]])
    free = contact.free(q, segment)
    q = q[free] if free.any() else free_solutions(problem, k, q_near)
    crowded = crowding_at(contact, q, segment)
    away = np.linalg.norm(q - q_near, axis=1)
    return np.array(q[np.lexsort((away, crowded))[0]])
