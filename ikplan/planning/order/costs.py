"""Cost between branches of stages: of the straight motion at first, of the way where it counts."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.path import MoveLeg
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.moves.move_planner import MovePlanner
from ikplan.planning.moves.region.way import inside
from ikplan.planning.moves.search import way_of
from ikplan.planning.order.measure import Measure
from ikplan.planning.order.stages import Stage

__all__ = ["BLOCKED", "START", "Costs", "Ways"]

START = -1
"""Stands for the begin of the motion among the stages."""
BLOCKED = 1e4
"""Cost that stands for no motion found: more than that of any."""

Pass = tuple[int, int, int, int]
"""A stage and its branch, and the stage and the branch that come next."""


class Ways:
    """Ways between branches of stages, each found once.

    Args:
        problem: The path.
        stages: Its stages.
        q_start: Where the motion begins, shape (dof,) [rad or m]; None: at any stage, for nothing.
    """

    def __init__(
        self, problem: JointPathProblem, stages: list[Stage], q_start: Array | None
    ) -> None:
        self.problem, self.stages, self.q_start = problem, stages, q_start
        self._planner = MovePlanner(problem)
        self._found: dict[Pass, Array | None] = {}

    def way(self, between: Pass) -> Array | None:
        """Return the way between two branches, shape (k, dof) [rad or m]; None: none was found.

        Raises:
            BudgetExceeded: The time budget ran out.
        """
        if between not in self._found:
            self.problem.clock.check()
            self._found[between] = self._search(between)
        return self._found[between]

    def _search(self, between: Pass) -> Array | None:
        i, a, j, b = between
        contact, stage = self.problem.contact, self.stages[j]
        q_to = stage.entries[b]
        q_from = self.q_start if i == START else self.stages[i].exits[a]
        if q_from is None:
            return np.asarray(q_to[None])
        straight = np.vstack([q_from, q_to])
        region = self._planner.region(stage.leg) if isinstance(stage.leg, MoveLeg) else None
        if contact is None and region is None:
            return straight
        if not stage.moves and contact is not None:
            return straight if contact.first_contact(straight, stage.part) is None else None
        if contact is not None and not contact.free(q_from[None], stage.part)[0]:
            return None
        if region is not None and not inside(region, q_from[None])[0]:
            return None
        way, _ = way_of(self.problem, q_from, q_to[None], stage.part, region)
        return None if way is None else way.q


class Costs:
    """Cost from where each stage ends to where each begins.

    A straight motion is a lower bound of every way; what has been looked at costs what it does.

    Args:
        ways: Finds the ways.
        measure: What they cost.
    """

    def __init__(self, ways: Ways, measure: Measure) -> None:
        self._ways, self._measure = ways, measure
        self._between: dict[tuple[int, int], Array] = {}
        self._known: set[Pass] = set()
        self.inner = [np.array([measure.way(q) for q in stage.tracked]) for stage in ways.stages]

    def between(self, i: int, j: int) -> Array:
        """Return the cost from every exit of stage i to every entry of stage j, (b_i, b_j)."""
        if (i, j) not in self._between:
            stages, q_start = self._ways.stages, self._ways.q_start
            entries = stages[j].entries
            if i != START:
                found = self._measure.straight(stages[i].exits[:, None] - entries[None])
            elif q_start is None:
                found = np.zeros((1, len(entries)))
            else:
                found = self._measure.straight(entries - q_start)[None]
            self._between[i, j] = found
        return self._between[i, j]

    def look_at(self, i: int, a: int, j: int, b: int) -> bool:
        """Find out what the motion from exit a of stage i to entry b of stage j costs.

        Returns:
            Whether it is more than was thought.

        Raises:
            BudgetExceeded: The time budget ran out.
        """
        if (i, a, j, b) in self._known:
            return False
        self._known.add((i, a, j, b))
        way = self._ways.way((i, a, j, b))
        cost = BLOCKED if way is None else self._measure.way(way)
        between = self.between(i, j)
        dearer = cost > between[a, b]
        between[a, b] = max(cost, between[a, b])
        return bool(dearer)
