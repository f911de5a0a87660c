"""Long searches end when their clock says so, and what they found then is not used."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import BudgetExceeded, load_robot
from ikplan.errors import IkplanError
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.metaheuristics.order import MERGED, ascending
from ikplan.ik.registry import find_solver
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.pipeline.poses import solve_ik_request
from ikplan.time_budget import SearchCut
from tests.ik.metaheuristics.runs import POPULATION_SEARCHES, problem, run

OUT_OF_REACH = np.array([9.0, 0.0, 0.0])


@pytest.mark.parametrize("name", [*POPULATION_SEARCHES, "newton-raphson"])
def test_a_search_stops_at_its_flag(name: str) -> None:
    robot = load_robot("iiwa14")
    arm, solver = arm_of(robot), find_solver(name)
    population = None if solver.population is None else 20
    searcher = Searcher(arm, solver, solver.check({}), 0, population, 50)
    target = pose_target(OUT_OF_REACH)
    whole = searcher.run(target, robot.home, arm.lower, arm.upper)
    assert whole.iterations[0] >= 49
    searcher.cut[0] = True
    with pytest.raises(SearchCut):
        searcher.run(target, robot.home, arm.lower, arm.upper)


@pytest.mark.parametrize("name", POPULATION_SEARCHES)
def test_the_flag_ends_the_search_at_once(name: str) -> None:
    task = problem(3, 20, 50)
    task.cut[0] = True
    assert run(name, task).iterations[0] <= 1


def test_one_iteration_of_a_large_gravitational_search_is_cut_too() -> None:
    # 20,000 masses that attract each other: 400 million forces an iteration, half a minute.
    task = problem(6, 20_000, 100)
    run("gsa", problem(6, 5, 2))
    timer = threading.Timer(0.3, task.cut.fill, [True])
    timer.start()
    begin = time.thread_time()
    outcome = run("gsa", task)
    timer.join()
    assert outcome.iterations[0] <= 2
    assert time.thread_time() - begin < 4.0


@pytest.mark.parametrize("name", [n for n in POPULATION_SEARCHES if n != "gsa"])
def test_a_candidate_takes_as_long_in_a_large_population_as_in_a_small_one(name: str) -> None:
    # What the bound on population times iterations rests on; gsa has one of its own.
    def per_evaluation(population: int, iterations: int) -> float:
        task = problem(6, population, iterations)
        begin = time.thread_time()
        outcome = run(name, task)
        return float((time.thread_time() - begin) / outcome.evaluations[0])

    per_evaluation(20, 2)
    small = min(per_evaluation(20, 200) for _ in range(3))
    assert per_evaluation(8000, 2) < 10.0 * small


def test_a_single_pose_whose_search_is_too_long_ends_with_its_budget() -> None:
    request = {
        "robot": "ur5",
        "position": [0.4, 0.1, 0.4],
        "ik": {"population": 10_000, "iterations": 1000},
        "budget_s": 0.2,
    }
    told: list[str] = []
    begin = time.thread_time()
    with pytest.raises(BudgetExceeded) as caught:
        solve_ik_request(request, progress=lambda *how_far: told.append(how_far[0]))
    assert time.thread_time() - begin < 5.0
    assert (caught.value.stage, caught.value.budget_s) == ("ik", 0.2)
    assert told == ["ik"]


@pytest.mark.parametrize("elongation", ["global", "greedy"])
def test_a_plan_whose_search_is_too_long_ends_with_its_budget(elongation: str) -> None:
    request: dict[str, Any] = {
        "robot": "iiwa14",
        "path": {"waypoints": [{"position": [0.5, 0.0, 0.5]}, {"position": [0.5, 0.1, 0.5]}]},
        "ik": {
            "method": "gsa",
            "population": 1_000,
            "iterations": 196,
            "elongation": elongation,
        },
        "budget_s": 0.4,
    }
    short = {**request, "ik": {**request["ik"], "population": 5, "iterations": 2}}
    ikplan.plan({**short, "budget_s": 3600})
    begin = time.thread_time()
    with pytest.raises(BudgetExceeded) as caught:
        ikplan.plan(request)
    assert time.thread_time() - begin < 3.0  # each of the two searches takes six seconds
    assert isinstance(caught.value, IkplanError)
    assert caught.value.stage == "ik"
    assert caught.value.budget_s == 0.4
    if elongation == "greedy":
        assert caught.value.best == {"waypoints_solved": 0, "q": []}


@pytest.mark.parametrize("count", [MERGED - 1, MERGED, MERGED + 1, 3 * MERGED])
def test_order_is_stable_whatever_the_size(count: int) -> None:
    values = np.round(np.random.default_rng(count).random(count), 2)
    np.testing.assert_array_equal(ascending(values), np.argsort(values, kind="stable"))
