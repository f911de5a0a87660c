"""A search asked for wrongly is refused, by field, with what is allowed."""

from __future__ import annotations

from typing import Any

import pytest

from ikplan.errors import InvalidRequest
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.registry import find_solver, solvers
from ikplan.kinematics.arm import arm_of
from ikplan.robots import load_robot


def refused(call: Any) -> InvalidRequest:
    with pytest.raises(InvalidRequest) as caught:
        call()
    return caught.value


@pytest.mark.parametrize(
    ("wrong", "near"), [("ikba", "ik-ba"), ("de-rand1", "de-rand-1"), ("BODE_CS", "bode-cs")]
)
def test_unknown_method_offers_near_names(wrong: str, near: str) -> None:
    error = refused(lambda: find_solver(wrong))
    assert error.field == "ik.method"
    assert near in error.detail
    assert near in error.allowed


@pytest.mark.parametrize("solver", solvers(), ids=lambda s: s.name)
def test_unknown_parameter_is_refused_with_the_known_ones(solver: Any) -> None:
    error = refused(lambda: solver.check({"alhpa": 0.5}))
    assert error.field == "ik.params.alhpa"
    assert error.allowed == sorted(p.name for p in solver.parameters)


@pytest.mark.parametrize("solver", solvers(), ids=lambda s: s.name)
def test_every_range_is_enforced_and_told(solver: Any) -> None:
    for p in solver.parameters:
        field = f"ik.params.{p.name}"
        wrong: list[Any] = [None, [1.0]]
        if p.choices:
            wrong += ["neither", 1]
        elif isinstance(p.default, bool):
            wrong += [1, "true"]
        else:
            wrong += ["fast", True, float("nan"), float("inf")]
            wrong += [p.minimum - 1] if p.minimum is not None else []
            wrong += [p.maximum + 1] if p.maximum is not None else []
            wrong += [p.default + 0.5] if isinstance(p.default, int) else []
        for value in wrong:
            error = refused(lambda v=value, p=p: solver.check({p.name: v}))
            assert error.field == field
            assert error.allowed
        if p.minimum is not None:
            assert f"{p.minimum:g}" in refused(lambda p=p: solver.check({p.name: -1e9})).detail


@pytest.mark.parametrize("solver", solvers(), ids=lambda s: s.name)
def test_defaults_are_within_their_own_ranges(solver: Any) -> None:
    values = solver.check({})
    assert solver.check(values) == values
    for preset in solver.presets:
        chosen = solver.check({"preset": preset})
        assert solver.check(chosen) == chosen


def test_a_parameter_given_overrides_the_preset() -> None:
    values = find_solver("pso").check({"preset": "kanagaraj", "c1": 1.0})
    assert (values["w"], values["c1"], values["c2"]) == (0.3033, 1.0, 3.2)


@pytest.mark.parametrize(
    "solver", [s for s in solvers() if s.min_population > 1], ids=lambda s: s.name
)
def test_a_population_too_small_for_the_strategy_is_refused(solver: Any) -> None:
    arm = arm_of(load_robot("iiwa14"))
    least = solver.min_population
    for population in (0, 1, least - 1):
        error = refused(lambda n=population: Searcher(arm, solver, solver.check({}), 0, n, 10))
        assert error.field == "ik.population"
        assert str(least) in error.allowed
    Searcher(arm, solver, solver.check({}), 0, least, 10)


def test_rand_2_needs_six() -> None:
    assert find_solver("de-rand-2").min_population == 6


def test_newton_raphson_has_no_population() -> None:
    arm, solver = arm_of(load_robot("iiwa14")), find_solver("newton-raphson")
    error = refused(lambda: Searcher(arm, solver, solver.check({}), 0, 10, 10))
    assert error.field == "ik.population"


@pytest.mark.parametrize("name", ["eod_arm", "ur5", "dobot_magician", "xarm7"])
def test_decoupling_needs_a_spherical_wrist(name: str) -> None:
    arm, solver = arm_of(load_robot(name)), find_solver("ik-ba")
    error = refused(lambda: Searcher(arm, solver, solver.check({"decouple": True}), 0))
    assert error.field == "ik.params.decouple"
    assert "spherical wrist" in error.detail


@pytest.mark.parametrize("value", ["many", -3, 0, 2.5])
def test_budget_must_be_a_number_of_at_least_one(value: Any) -> None:
    arm, solver = arm_of(load_robot("iiwa14")), find_solver("ik-ba")
    values = solver.check({})
    assert refused(lambda: Searcher(arm, solver, values, 0, value, 5)).field == "ik.population"
    assert refused(lambda: Searcher(arm, solver, values, 0, 5, value)).field == "ik.iterations"
