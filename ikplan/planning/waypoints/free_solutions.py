"""Many solutions of one waypoint, of which those free of contact are kept."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.kinematics.target import Target
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.waypoints.in_collision import in_collision, pose_in_collision
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["free_solutions"]

_CAP = 400
_SEEDS = 1500
"""Evenly spread seeds: more than elsewhere, since the usual ones are all in contact."""


def free_solutions(problem: WaypointProblem, k: int, q_near: Array) -> Array:
    """Return solutions of a waypoint that are free of contact, nearest first, shape (c, dof).

    Args:
        problem: The targets, and what refuses configurations.
        k: Index of the waypoint.
        q_near: Where they should be near to, shape (dof,) [rad or m].

    Raises:
        InCollision: All that were found are in contact; how many, and for which pairs. Proven
            where what moves with the tool is in contact at the pose itself.
    """
    assert problem.contact is not None
    arm = problem.solver.arm
    found = sample_ik_solutions(
        arm.chain,
        stack_targets(problem.targets[k : k + 1]),
        np.empty((1, 0, arm.dof)),
        q_near,
        arm.lower,
        arm.upper,
        _CAP,
        _SEEDS,
        0,
        (0.5 + problem.solver.seed * 0.6180339887498949) % 1.0,
        1e-9,
        arm.closed_form,
    )
    q = found.q[0, : found.counts[0]]
    order = np.argsort(np.linalg.norm(q - q_near, axis=1), kind="stable")
    found_any = len(q) > 0
    q = np.ascontiguousarray(q[order]) if found_any else q_near[None]
    free = problem.contact.free(q, problem.segment(k))
    if not free.any():
        row, segment = problem.first_row + k, problem.segment(k)
        if found_any and _is_fixed(problem.targets[k]):
            held = problem.contact.tool_contact(q[0], segment)
            if held is not None:
                raise pose_in_collision(problem.contact, q[0], row, held, segment)
        raise in_collision(problem.contact, q, row, f"waypoint {row}", segment)
    return q[free]


def _is_fixed(target: Target) -> bool:
    """Whether a target leaves nothing of the tool's pose free."""
    free = target.freedom
    return target.oriented and free.axis < 0 and not free.boxed
