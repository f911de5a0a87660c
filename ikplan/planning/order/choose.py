"""The order of the tasks, and the branch of each stage, that cost least.

Costs begin as straight motions, which no way undercuts. A tour through one branch of every task is
looked for, the branches of its stages are then chosen exactly for its order, and the ways that it
takes are looked at; where they are longer, this is done again with what is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.order.costs import BLOCKED, START, Costs
from ikplan.planning.order.stages import Stage
from ikplan.planning.order.tasks import Place
from ikplan.planning.order.tour import shortest_tour

__all__ = ["Choice", "Cluster", "best_branches", "choose_order"]

_ROUNDS = 4
"""Tours looked for, each with the ways of those before."""
_EVERY_PAIR = 24
"""Tasks up to which the shortest motion between each two is looked at beforehand."""
_FORBIDDEN = 10.0 * BLOCKED


@dataclass(frozen=True)
class Cluster:
    """A task as the choice sees it.

    Attributes:
        stages: Indices of its stages, in order, at least one.
        place: Where among the tasks it comes.
    """

    stages: tuple[int, ...]
    place: Place = "any"


@dataclass(frozen=True)
class Choice:
    """An order and the branches taken in it.

    Attributes:
        clusters: Indices of the tasks in the order passed.
        stages: Indices of their stages in the order passed.
        branches: The branch of each of these.
        cost: Cost in all, tool paths included.
    """

    clusters: tuple[int, ...]
    stages: tuple[int, ...]
    branches: tuple[int, ...]
    cost: float


def choose_order(clusters: Sequence[Cluster], stages: Sequence[Stage], costs: Costs) -> Choice:
    """Return the order found that costs least.

    Args:
        clusters: The tasks, at least one; one at most stays first, one at most last.
        stages: All stages.
        costs: Motion between their branches.

    Raises:
        InvalidRequest: OR-tools is not installed.
        BudgetExceeded: The time budget ran out.
    """
    given = tuple(range(len(clusters)))
    best = best_branches(given, clusters, costs)
    if len(clusters) <= _EVERY_PAIR:
        _look_at_pairs(clusters, costs)
    seen = {given}
    for _ in range(_ROUNDS):
        order = _tour(clusters, stages, costs)
        if order in seen:
            break
        seen.add(order)
        found = best_branches(order, clusters, costs)
        if found.cost < best.cost:
            best = found
    return best


def best_branches(order: Sequence[int], clusters: Sequence[Cluster], costs: Costs) -> Choice:
    """Return the branches that are shortest in an order, every way between them looked at.

    Args:
        order: Indices of the tasks in that order.
        clusters: The tasks.
        costs: Cost between the branches of their stages.

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    passed = tuple(k for c in order for k in clusters[c].stages)
    while True:
        branches, length = _shortest(passed, costs)
        fresh = False
        before, at = START, 0
        for stage, branch in zip(passed, branches, strict=True):
            fresh |= costs.look_at(before, at, stage, branch)
            before, at = stage, branch
        if not fresh:
            return Choice(tuple(order), passed, branches, length)


def _shortest(passed: Sequence[int], costs: Costs) -> tuple[tuple[int, ...], float]:
    """The shortest way through one branch of each stage, in order, and its length."""
    lengths, come_from = np.zeros(1), []
    before = START
    for k in passed:
        through = lengths[:, None] + costs.between(before, k)
        come_from.append(np.argmin(through, axis=0))
        lengths = through.min(axis=0) + costs.inner[k]
        before = k
    at = int(np.argmin(lengths))
    length, branches = float(lengths[at]), [at]
    for step in reversed(come_from[1:]):
        at = int(step[at])
        branches.append(at)
    return tuple(reversed(branches)), length


def _look_at_pairs(clusters: Sequence[Cluster], costs: Costs) -> None:
    """Look at the shortest motion from the start and every task to every other, and within."""
    pairs = [(START, cluster.stages[0]) for cluster in clusters]
    for one in clusters:
        pairs += list(zip(one.stages, one.stages[1:], strict=False))
        pairs += [(one.stages[-1], other.stages[0]) for other in clusters if other is not one]
    for i, j in pairs:
        motion = costs.between(i, j)
        a, b = np.unravel_index(int(np.argmin(motion)), motion.shape)
        costs.look_at(i, int(a), j, int(b))


def _tour(clusters: Sequence[Cluster], stages: Sequence[Stage], costs: Costs) -> tuple[int, ...]:
    """The order of a short tour; a node is an entry of a task, left by the exit nearest to it."""
    node_of: list[tuple[int, int]] = []
    inner: list[float] = []
    exits: list[int] = []
    for c, cluster in enumerate(clusters):
        first = cluster.stages[0]
        for a in range(len(stages[first].entries)):
            reached, length = _inside(cluster, a, stages, costs)
            node_of.append((c, a))
            exits.append(reached)
            inner.append(length)
    count = len(node_of) + 2
    matrix = np.full((count, count), _FORBIDDEN)
    cluster_of = np.array([-1, *(c for c, _ in node_of), -1], dtype=np.int64)
    places = [cluster.place for cluster in clusters]
    for m, (c, a) in enumerate(node_of, start=1):
        if places[c] == "first" or "first" not in places:
            motion = costs.between(START, clusters[c].stages[0])
            matrix[0, m] = motion[0, a] + inner[m - 1]
        if places[c] == "last" or "last" not in places:
            matrix[m, -1] = 0.0
        left_from = clusters[c].stages[-1]
        for n, (d, b) in enumerate(node_of, start=1):
            if d != c and places[c] != "last" and places[d] != "first":
                motion = costs.between(left_from, clusters[d].stages[0])
                matrix[m, n] = motion[exits[m - 1], b] + inner[n - 1]
    nodes = shortest_tour(matrix, cluster_of)
    return tuple(int(cluster_of[node]) for node in nodes)


def _inside(cluster: Cluster, a: int, stages: Sequence[Stage], costs: Costs) -> tuple[int, float]:
    """The exit of a task nearest to one of its entries, and the motion to there."""
    first = cluster.stages[0]
    lengths: Array = np.full(len(stages[first].entries), np.inf)
    lengths[a] = costs.inner[first][a]
    for before, k in zip(cluster.stages, cluster.stages[1:], strict=False):
        lengths = (lengths[:, None] + costs.between(before, k)).min(axis=0) + costs.inner[k]
    at = int(np.argmin(lengths))
    return at, float(lengths[at])
