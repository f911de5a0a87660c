"""Ends a way at another of its goals where that makes it shorter.

A search ends at the goal that it happens to reach first; from one of the corners of the way there a
nearer goal may be reached straight.
"""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.scratch import Scratch
from ikplan.planning.moves.connect import SearchSpace, is_free

__all__ = ["with_nearer_goal"]

_TRIED = 200
"""Straight motions to goals that are looked at, at most."""


def with_nearer_goal(space: SearchSpace, way: Array, goals: Array, w: Scratch) -> Array:
    """Return the way or a shorter one, which goes straight from one of its corners to a goal.

    Args:
        space: What it must not touch.
        way: Configurations between which the motion is straight and free, shape (k, dof), k >= 2
            [rad or m].
        goals: The goals, free of contact, shape (g, dof) [rad or m].
        w: Work space for the check.
    """
    if len(goals) == 1:
        return way
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1)))
    to_goals = np.linalg.norm(goals[None] - way[:-1, None], axis=2)
    lengths = along[:-1, None] + to_goals
    order = np.argsort(lengths, axis=None, kind="stable")[:_TRIED]
    for at in order:
        corner, goal = divmod(int(at), len(goals))
        if lengths[corner, goal] >= along[-1]:
            break
        if is_free(space, way[corner], goals[goal], w):
            return np.vstack([way[: corner + 1], goals[goal]])
    return way
