"""The searches on any objective."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from ikplan import InvalidRequest
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.population import COLD, Problem
from ikplan.ik.minimise import RANDOM, minimise, minimisers
from ikplan.ik.objective import SPHERE, function_objective
from ikplan.ik.registry import find_solver


def bowl(x: Array) -> float:
    return float(((x - 0.3) ** 2).sum())


@pytest.mark.parametrize("name", minimisers())
def test_a_search_stays_within_bounds_and_budget_and_repeats_itself(name: str) -> None:
    first, again = (minimise(bowl, [-1, -2], [1, 2], solver=name, budget=120) for _ in range(2))
    assert len(first.values) <= 120
    assert (np.abs(first.X) <= [1.0, 2.0]).all()
    np.testing.assert_array_equal(first.X, again.X)
    assert first.value == first.values.min() == bowl(first.x)
    other = minimise(bowl, [-1, -2], [1, 2], solver=name, budget=120, rng=1)
    assert not np.array_equal(first.X, other.X)


@pytest.mark.parametrize("name", ["de-best-1", "de-rand-2", "sde", "pso"])
def test_in_python_a_search_finds_what_its_kernel_finds(name: str) -> None:
    """The same source, the same generator, the same values: the same candidates."""
    solver = find_solver(name)
    low, high = np.full(3, -1.0), np.full(3, 2.0)
    problem = Problem(
        function_objective(SPHERE), low, high, np.zeros(3), COLD, 0, 10, 9, -1.0,
        np.zeros(1, dtype=np.bool_),
    )  # fmt: skip
    packed = solver.pack(solver.check({}))
    compiled = solver.load()(problem, packed, np.random.default_rng(3))
    assert int(compiled.evaluations[0]) == 100
    found = minimise(
        lambda x: x[0] * x[0] + x[1] * x[1] + x[2] * x[2],
        low, high, solver=name, budget=100, rng=3, population=10,
    )  # fmt: skip
    np.testing.assert_allclose(found.x, compiled.x, atol=1e-9)
    assert found.value == pytest.approx(float(compiled.f[0]), abs=1e-12)


def test_a_search_starts_where_it_is_told_and_ends_at_a_good_value() -> None:
    found = minimise(bowl, [-1] * 3, [1] * 3, solver="de-rand-1", budget=50, start=[0.5, 0.5, 0.5])
    np.testing.assert_array_equal(found.X[0], [0.5, 0.5, 0.5])
    short = minimise(bowl, [-1] * 3, [1] * 3, budget=500, stop_value=0.1)
    assert short.value <= 0.1
    assert (short.values[:-1] > 0.1).all()
    random = minimise(bowl, [-1], [1], solver=RANDOM, budget=7, start=[0.3])
    assert random.value == 0.0
    assert len(random.values) == 7


def test_values_that_are_no_numbers_are_the_worst() -> None:
    def holes(x: Array) -> float:
        return math.nan if x[0] < 0.0 else float(x[0])

    found = minimise(holes, [-1], [1], solver="ga", budget=60)
    assert 0.0 <= found.value < 0.2


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"solver": "lm"}, "solver"),
        ({"solver": "ik-ba"}, "solver"),
        ({"budget": 0}, "budget"),
        ({"upper": [-2.0, 1.0]}, "bounds"),
        ({"upper": [math.inf, 1.0]}, "bounds"),
        ({"upper": [1.0]}, "bounds"),
        ({"params": {"F": "large"}}, "ik.params.F"),
    ],
)
def test_what_makes_no_sense_is_refused(changes: dict[str, object], field: str) -> None:
    given: dict[str, Any] = {"lower": [-1.0, -1.0], "upper": [1.0, 1.0], **changes}
    with pytest.raises(InvalidRequest) as caught:
        minimise(bowl, **given)
    assert caught.value.field == field
