"""The way of a move: straight where straight is free, else searched for and shortened."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.collision.check import ContactArrays
from ikplan.planning.moves.connect import CUT, SearchSpace, connect, is_free
from ikplan.planning.moves.nearer_goal import with_nearer_goal
from ikplan.planning.moves.shorten import path_length, shorten
from ikplan.planning.moves.space import search_space
from ikplan.time_budget import SearchCut

__all__ = ["DEFAULT_EFFORT", "Way", "find_way"]

DEFAULT_EFFORT = 20_000
"""Samples drawn at most where a request does not say."""
_SHORTCUT = 200
"""Samples for every shortcut that is tried."""
_SEARCHES = 3
"""Searches at most where there are several goals: the first one reached may not be the nearest."""
_SEARCH_ON = 20
"""What part of the effort a search may use for a shorter way than one known."""


@dataclass(frozen=True, eq=False)
class Way:
    """A joint motion, straight between its configurations.

    Attributes:
        q: Configurations, shape (k, dof), k >= 2 [rad or m].
        goal: Index of the goal that it leads to.
        found_length: Joint distance along the way before it was shortened [rad or m].
        samples: Samples drawn in all searches.
    """

    q: Array
    goal: int
    found_length: float
    samples: int

    @property
    def length(self) -> float:
        """Joint distance along the way [rad or m]."""
        return float(path_length(self.q))


def find_way(
    arrays: ContactArrays,
    limits: tuple[Array, Array],
    q_start: Array,
    goals: Array,
    effort: int | None,
    seed: int,
    cut: Flags,
    extra: Array | None = None,
) -> tuple[Way | None, int]:
    """Look for a short way from a start to any of some goals, every part proven to be free.

    Args:
        arrays: What must not be touched.
        limits: Lower and upper position limits, shape (dof,) each [rad or m].
        q_start: The start, free of contact, shape (dof,) [rad or m].
        goals: The goals, free of contact, shape (g, dof), g >= 1 [rad or m].
        effort: Samples drawn at most by a search; None: 20,000.
        seed: Seed of the random numbers.
        cut: Shape (1,): true ends a search.
        extra: What ending at each goal costs besides the way, shape (g,); None: nothing.

    Returns:
        The way, None where none was found, and the samples drawn.

    Raises:
        SearchCut: The search was ended.
    """
    effort = DEFAULT_EFFORT if effort is None else effort
    # Kernels are compiled once, for arrays that may be written.
    q_start, goals = np.array(q_start), np.array(goals)
    straight = np.linalg.norm(goals - q_start, axis=1)
    ends = np.zeros(len(goals)) if extra is None else extra
    least = straight + ends
    order = np.argsort(least, kind="stable")
    space = search_space(arrays, *limits, q_start, goals)
    best: Way | None = None
    for goal in order:
        if is_free(space, q_start, goals[goal], arrays.scratch):
            q = np.vstack([q_start, goals[goal]])
            best = Way(q, int(goal), float(straight[goal]), 0)
            break
    open_goals = [int(g) for g in order if best is None or least[g] < least[best.goal]]
    samples = 0
    for search in range(_SEARCHES):
        if not open_goals:
            break
        most = effort if best is None else max(effort // _SEARCH_ON, 1)
        rng = np.random.default_rng([seed, search])
        found, used = _searched(space, arrays, q_start, goals[open_goals], most, effort, rng, cut)
        samples += used
        if found is None:
            break
        way = Way(found.q, open_goals[found.goal], found.found_length, used)
        if best is None or way.length + ends[way.goal] < best.length + ends[best.goal]:
            best = way
        bound = best.length + ends[best.goal]
        open_goals = [g for g in open_goals if g != way.goal and least[g] < bound]
    return best, samples


def _searched(
    space: SearchSpace,
    arrays: ContactArrays,
    q_start: Array,
    goals: Array,
    most: int,
    effort: int,
    rng: np.random.Generator,
    cut: Flags,
) -> tuple[Way | None, int]:
    """One search and its shortening."""
    path, used = connect(space, q_start, goals, most, rng, cut, arrays.scratch)
    if used == CUT:
        raise SearchCut
    if len(path) == 0:
        return None, used
    found_length = float(path_length(path))
    shorter = shorten(space, path, max(effort // _SHORTCUT, 1), rng, arrays.scratch)
    ending = with_nearer_goal(space, shorter, goals, arrays.scratch)
    if ending is not shorter:
        shorter = shorten(space, ending, max(effort // _SHORTCUT, 1), rng, arrays.scratch)
    goal = int(np.argmin(np.abs(goals - shorter[-1]).max(axis=1)))
    return Way(shorter, goal, found_length, used), used
