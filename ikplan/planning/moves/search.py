"""The search for the way of a move, of whichever kind, within the time budget."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.checker import CollisionChecker
from ikplan.errors import InvalidRequest
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.ladder.motion_cost import posture_distances
from ikplan.planning.moves.ompl_engine import find_way_by_ompl
from ikplan.planning.moves.region.tool_region import ToolRegion
from ikplan.planning.moves.region.way import find_way_within
from ikplan.planning.moves.way import Way, find_way
from ikplan.scene.body import CollisionModel

__all__ = ["way_of"]

_NOTHING = CollisionModel((), np.empty((0, 2), dtype=np.int64), 0.0)
"""What is in the way where nothing is checked."""
_WATCHED = 10**9
"""Longer than any search that no thread need watch: a search of moves is always watched."""


def way_of(
    problem: JointPathProblem,
    q_start: Array,
    goals: Array,
    segment: int | None,
    region: ToolRegion | None,
) -> tuple[Way | None, int]:
    """Look for a way of a move; see ``find_way``.

    Args:
        problem: The path of which it is a move.
        q_start: The start, free of contact, shape (dof,) [rad or m].
        goals: The goals, free of contact, shape (g, dof), g >= 1 [rad or m].
        segment: Number of its segment; None: not known.
        region: Where the tool stays; None: anywhere.

    Raises:
        InvalidRequest: The engine asked for is not installed, or knows no regions.
        BudgetExceeded: The time budget ran out.
    """
    cut = np.zeros(1, dtype=np.bool_)
    limits = (problem.robot.lower, problem.robot.upper)
    effort, seed = problem.options.effort, problem.options.seed
    contact = problem.contact or CollisionChecker(problem.robot, _NOTHING)
    arrays = contact.arrays(segment)
    problem.clock.check()
    engine = problem.options.move_engine
    if engine != "ikplan" and region is not None:
        raise InvalidRequest(
            "ik.move_engine: only ikplan's own search keeps the tool within a region",
            field="ik.move_engine",
            allowed=["ikplan"],
        )
    with problem.clock.cutting(cut, _WATCHED):
        if engine != "ikplan":
            planner = engine.removeprefix("ompl:")
            return find_way_by_ompl(planner, arrays, limits, q_start, goals, effort, seed, cut)
        if region is None:
            extra = posture_distances(goals, problem.cost)
            return find_way(arrays, limits, q_start, goals, effort, seed, cut, extra)
        return find_way_within(arrays, region, limits, q_start, goals, effort, seed, cut)
