"""Planners of OMPL behind the same interface: their edges are proven, their ways shortened alike.

I. A. Șucan, M. Moll and L. E. Kavraki, "The Open Motion Planning Library", IEEE Robotics and
Automation Magazine 19 (4), 2012. Seeded, and ended by how often they ask whether to end, never by
the clock.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.collision.check import ContactArrays
from ikplan.errors import InvalidRequest
from ikplan.planning.moves.connect import SearchSpace, is_free
from ikplan.planning.moves.shorten import path_length, shorten
from ikplan.planning.moves.space import search_space
from ikplan.planning.moves.way import DEFAULT_EFFORT, Way
from ikplan.time_budget import SearchCut

__all__ = ["find_way_by_ompl"]

_GOALS = 3
"""Goals that are tried one after the other, nearest first."""
_SHORTCUT = 200
"""Effort for every shortcut that is tried."""


def find_way_by_ompl(
    planner: str,
    arrays: ContactArrays,
    limits: tuple[Array, Array],
    q_start: Array,
    goals: Array,
    effort: int | None,
    seed: int,
    cut: Flags,
) -> tuple[Way | None, int]:
    """Look for a way by a planner of OMPL; the other arguments as of ``find_way``.

    Args:
        planner: Name of its class in ``ompl.geometric``.
        arrays: What must not be touched.
        limits: Lower and upper position limits, shape (dof,) each [rad or m].
        q_start: The start, free of contact, shape (dof,) [rad or m].
        goals: The goals, free of contact, shape (g, dof), g >= 1 [rad or m].
        effort: Iterations of the planner at most; None: 20,000.
        seed: Seed of its random numbers.
        cut: Shape (1,): true ends a search.

    Returns:
        The way, None where none was found, and the iterations.

    Raises:
        InvalidRequest: OMPL is not installed.
        SearchCut: The search was ended.
    """
    library = _library()
    effort = DEFAULT_EFFORT if effort is None else effort
    q_start, goals = np.array(q_start), np.array(goals)
    straight = np.linalg.norm(goals - q_start, axis=1)
    order = [int(goal) for goal in np.argsort(straight, kind="stable")]
    space = search_space(arrays, *limits, q_start, goals)
    for goal in order:
        if is_free(space, q_start, goals[goal], arrays.scratch):
            return Way(np.vstack([q_start, goals[goal]]), goal, float(straight[goal]), 0), 0
    used = 0
    for goal in order[:_GOALS]:
        path, spent = _planned(
            library, planner, space, arrays, q_start, goals[goal], effort, seed, cut
        )
        used += spent
        if cut[0]:
            raise SearchCut
        if path is None:
            continue
        rng = np.random.default_rng([seed, 0])
        shorter = shorten(space, path, max(effort // _SHORTCUT, 1), rng, arrays.scratch)
        return Way(shorter, goal, float(path_length(path)), used), used
    return None, used


def _library() -> tuple[Any, Any, Any]:
    """The modules of OMPL.

    Raises:
        InvalidRequest: It is not installed.
    """
    try:
        base, geometric, util = (
            importlib.import_module(f"ompl.{name}") for name in ("base", "geometric", "util")
        )
    except ModuleNotFoundError as error:
        raise InvalidRequest(
            'ik.move_engine: OMPL is not installed: pip install "ikplan[ompl]"',
            field="ik.move_engine",
            allowed=["ikplan"],
        ) from error
    util.setLogLevel(util.LogLevel.LOG_NONE)
    return base, geometric, util


def _planned(
    library: tuple[Any, Any, Any],
    planner: str,
    space: SearchSpace,
    arrays: ContactArrays,
    q_start: Array,
    goal: Array,
    effort: int,
    seed: int,
    cut: Flags,
) -> tuple[Array | None, int]:
    """The way of a planner, every part of it proven to be free; None: none was found."""
    base, geometric, util = library
    dof = len(q_start)
    util.RNG.setSeed(seed % (2**32 - 1) + 1)  # 0 would be drawn from the clock

    def values(state: Any) -> Array:
        return np.array([state[d] for d in range(dof)], dtype=np.float64)

    class Proven(base.MotionValidator):  # type: ignore[misc, name-defined]
        def checkMotion(self, first: Any, second: Any, *_: Any) -> bool:
            return bool(is_free(space, values(first), values(second), arrays.scratch))

    states, bounds = base.RealVectorStateSpace(dof), base.RealVectorBounds(dof)
    for d in range(dof):
        bounds.setLow(d, float(space.lower[d]))
        bounds.setHigh(d, float(space.upper[d]))
    states.setBounds(bounds)
    setup = geometric.SimpleSetup(states)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(
        lambda state: bool(is_free(space, values(state), values(state), arrays.scratch))
    )
    validator = Proven(information)
    information.setMotionValidator(validator)
    ends = []
    for q in (q_start, goal):
        state = states.allocState()
        for d in range(dof):
            state[d] = float(q[d])
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(getattr(geometric, planner)(information))
    asked = 0

    def at_its_end() -> bool:
        nonlocal asked
        asked += 1
        return bool(asked > effort or cut[0])

    setup.solve(base.PlannerTerminationCondition(at_its_end))
    if cut[0] or not setup.haveExactSolutionPath():
        return None, min(asked, effort)
    path = np.array([values(state) for state in setup.getSolutionPath().getStates()])
    path[0], path[-1] = q_start, goal
    return path, min(asked, effort)  # some ask once more at their end
