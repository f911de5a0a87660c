"""The shortest way over a ladder of steps, against all ways."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ikplan.planning.ladder.free_ladder import shortest_way

Array = NDArray[np.float64]
Step = Callable[[int, Array, Array], Array | None]


def test_the_way_is_the_shortest_of_all_whose_steps_can_be_taken() -> None:
    rng = np.random.default_rng(0)
    found = blocked = 0
    for _ in range(40):
        rungs = [rng.uniform(-0.5, 0.5, (int(rng.integers(1, 5)), 2)) for _ in range(4)]
        costs = rng.uniform(0.0, 0.3, len(rungs[0]))
        walls = rng.uniform(-0.5, 0.5, (4, 2))

        def step(k: int, before: Array, after: Array, walls: Array = walls) -> Array | None:
            middle = 0.5 * (before + after)
            near = np.linalg.norm(middle - walls[k]) < 0.35
            return None if near else np.asarray(middle)

        def join(
            k: int, cost: Array, before: Array, after: Array, step: Step = step
        ) -> tuple[Array, NDArray[np.intp], Array]:
            reached, parent = np.full(len(after), np.inf), np.full(len(after), -1)
            for (i, p), (j, q) in itertools.product(enumerate(before), enumerate(after)):
                total = cost[i] + np.linalg.norm(q - p)
                near = np.abs(q - p).max() <= 0.7
                if near and total < reached[j] and step(k, p, q) is not None:
                    reached[j], parent[j] = total, i
            return reached, parent, 0.5 * (before[parent] + after)

        lengths = []
        for way in itertools.product(*(range(len(rung)) for rung in rungs)):
            q = np.array([rung[i] for rung, i in zip(rungs, way, strict=True)])
            gaps = np.abs(np.diff(q, axis=0)).max(axis=1)
            if (gaps <= 0.7).all() and all(step(k, q[k - 1], q[k]) is not None for k in (1, 2, 3)):
                lengths.append(costs[way[0]] + np.linalg.norm(np.diff(q, axis=0), axis=1).sum())
        result = shortest_way(rungs, costs, join)
        if result is None:
            blocked += 1
            assert lengths == []
            continue
        found += 1
        q, middles = result
        begin = int(np.flatnonzero((rungs[0] == q[0]).all(axis=1))[0])
        length = costs[begin] + np.linalg.norm(np.diff(q, axis=0), axis=1).sum()
        assert length <= min(lengths) + 1e-12
        np.testing.assert_array_equal(middles, 0.5 * (q[:-1] + q[1:]))
    assert found > 5
    assert blocked > 0
