"""The way out of contact at the start, where a request asks for one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.collision.checker import CollisionChecker
from ikplan.documents.segment import JointSegment, MoveSegment
from ikplan.errors import InvalidRequest
from ikplan.kinematics.arm import Arm
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.waypoints.in_collision import in_collision

__all__ = ["leaving_contact", "way_out"]

_RADII = (0.02, 0.04, 0.08, 0.15, 0.3, 0.6)
"""Joint distances at which places free of contact are looked for in turn [rad or m]."""
_DIRECTIONS = 200
"""Directions of each."""
_BEYOND = 1e-3
"""Gap beyond that of the check which the place has [m]."""
_HALVINGS = 8


def leaving_contact(problem: JointPathProblem, check: CollisionChecker | None) -> JointPathProblem:
    """Return a path whose start in contact is left first; the same where it is free.

    Args:
        problem: The path.
        check: The check; None: nothing is checked.

    Raises:
        InvalidRequest: The path begins with a tool path at the start.
        InCollision: No way out was found.
    """
    if check is None or problem.start_free or check.free(problem.q_start[None], 0)[0]:
        return problem
    path = problem.path
    first = path.segments[0] if path.segments and path.begin is None else None
    joints = path.waypoints is not None and path.interpolation == "joint"
    if not (path.approach != "path" or joints or isinstance(first, MoveSegment | JointSegment)):
        raise InvalidRequest(
            "scene.leave_contact: the tool path begins at a start in contact; begin with a move or "
            'a joint motion, or set path.approach to "move"',
            field="scene.leave_contact",
            allowed=[False],
        )
    free, touching = way_out(check, problem.solver.arm, problem.q_start, problem.options.seed)
    return replace(problem, q_start=free, left_from=problem.q_start, left=touching)


def way_out(check: CollisionChecker, arm: Arm, q_start: Array, seed: int) -> tuple[Array, Indices]:
    """Return a place free of contact near a start in contact, and the pairs that touch there.

    The straight motion to it is free but for those pairs.

    Args:
        check: The check.
        arm: The arm.
        q_start: The start, shape (dof,) [rad or m].
        seed: Seed of the directions.

    Returns:
        The place, shape (dof,) [rad or m], and rows of the model's pairs.

    Raises:
        InCollision: None was found.
    """
    touching = check.touching(q_start, 0)
    clear, others = check.wider(_BEYOND), check.ignoring(touching)
    rng = np.random.default_rng([seed, len(q_start)])
    for radius in _RADII:
        directions = rng.normal(size=(_DIRECTIONS, len(q_start)))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        places = np.clip(q_start + radius * directions, arm.lower, arm.upper)
        shortened = [
            _shortened(clear, q_start, place)
            for place in places[clear.free(places, 0)]
            if others.first_contact(np.vstack([q_start, place]), 0) is None
        ]
        if shortened:
            away = [float(np.linalg.norm(place - q_start)) for place in shortened]
            return shortened[int(np.argmin(away))], touching
    subject = "the start, from which no way out of contact was found"
    raise in_collision(check, q_start[None], -1, subject, 0, proven=True)


def _shortened(clear: CollisionChecker, q_start: Array, place: Array) -> Array:
    """The nearest place found on the way to one, from which on all of it is free."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        rest = np.vstack([q_start + middle * (place - q_start), place])
        if clear.first_contact(rest, 0) is None:
            high = middle
        else:
            low = middle
    return np.asarray(q_start + high * (place - q_start))
