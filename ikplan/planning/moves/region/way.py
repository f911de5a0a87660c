"""The way of a move on which the tool keeps within a region."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.collision.check import ContactArrays
from ikplan.planning.moves.connect import CUT
from ikplan.planning.moves.region.kernels import excess
from ikplan.planning.moves.region.search import connect_within, passable, shorten_within
from ikplan.planning.moves.region.tool_region import ToolRegion, region_scratch
from ikplan.planning.moves.shorten import path_length
from ikplan.planning.moves.space import search_space
from ikplan.planning.moves.way import DEFAULT_EFFORT, Way
from ikplan.time_budget import SearchCut

__all__ = ["find_way_within", "inside"]

_SHORTCUT = 200
"""Samples for every shortcut that is tried."""


def inside(region: ToolRegion, q: Array) -> Flags:
    """Return which configurations, shape (m, dof) [rad or m], have the tool inside, shape (m,)."""
    w = region_scratch(region.chain)
    return np.array([max(excess(region, 1.0, row, w)) <= 0.0 for row in np.array(q)], dtype=bool)


def find_way_within(
    arrays: ContactArrays,
    region: ToolRegion,
    limits: tuple[Array, Array],
    q_start: Array,
    goals: Array,
    effort: int | None,
    seed: int,
    cut: Flags,
) -> tuple[Way | None, int]:
    """Look for a short way within a region; arguments and errors as of ``find_way``."""
    effort = DEFAULT_EFFORT if effort is None else effort
    q_start, goals = np.array(q_start), np.array(goals)
    straight = np.linalg.norm(goals - q_start, axis=1)
    space = search_space(arrays, *limits, q_start, goals)
    w, v = arrays.scratch, region_scratch(region.chain)
    for goal in np.argsort(straight, kind="stable"):
        if passable(space, region, q_start, goals[goal], w, v):
            q = np.vstack([q_start, goals[goal]])
            return Way(q, int(goal), float(straight[goal]), 0), 0
    rng = np.random.default_rng([seed, 0])
    path, used = connect_within(space, region, q_start, goals, effort, rng, cut, w, v)
    if used == CUT:
        raise SearchCut
    if len(path) == 0:
        return None, used
    found = float(path_length(path))
    shorter = shorten_within(space, region, path, max(effort // _SHORTCUT, 1), rng, w, v)
    goal = int(np.argmin(np.abs(goals - shorter[-1]).max(axis=1)))
    return Way(shorter, goal, found, used), used
