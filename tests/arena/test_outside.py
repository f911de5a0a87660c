"""Solvers from outside: what they minimise, how they enter, and that nothing is lost on the way."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.errors import InvalidRequest
from ikplan.ik import registry
from ikplan.ik.outside.pose_objective import BudgetSpent, PoseObjective
from ikplan.ik.solver import Parameter
from ikplan.robots import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return ikplan.load_robot("iiwa14")


def descent(objective: PoseObjective, rng: np.random.Generator, step: float = 0.5) -> None:
    best, value = objective.start, float(objective(objective.start))
    while True:
        candidates = best + step * rng.standard_normal((10, objective.dof))
        values = objective(candidates)
        k = int(values.argmin())
        if values[k] < value:
            best, value, step = candidates[k], float(values[k]), 1.3 * step
        else:
            step *= 0.8


def test_objective_is_the_distance_of_the_tool(robot: Robot) -> None:
    rng = np.random.default_rng(1)
    target = robot.fk(robot.random_configuration(rng))
    X = np.array([robot.random_configuration(rng) for _ in range(20)])
    position = ikplan.objective(robot, target.translation)
    pose = ikplan.objective(robot, target, weight_position=2.0, weight_orientation=0.3)
    for x, p, w in zip(X, position(X), pose(X), strict=True):
        reached = robot.fk(x)
        distance = np.linalg.norm(reached.translation - target.translation)
        turned = np.linalg.norm(reached.rotation - target.rotation)
        assert p == pytest.approx(distance, abs=1e-12)
        assert w == pytest.approx(2.0 * distance + 0.3 * turned, abs=1e-12)
    assert position.spent == 20
    assert position.best_f == position(X).min()


def test_motion_weighs_the_distance_from_the_start(robot: Robot) -> None:
    rng = np.random.default_rng(2)
    start, target = robot.random_configuration(rng), robot.fk(robot.random_configuration(rng))
    X = np.array([robot.random_configuration(rng) for _ in range(20)])
    plain = ikplan.objective(robot, target, start=start)(X)
    weighed = ikplan.objective(robot, target, start=start, weight_motion=0.05)(X)
    np.testing.assert_allclose(
        weighed - plain, 0.05 * np.linalg.norm(X - start, axis=1), atol=1e-12
    )


def test_a_scene_adds_a_term_near_the_target_only(robot: Robot) -> None:
    q = np.array([0.3, 0.5, 0.2, -1.0, 0.4, 0.6, 0.1])
    target = robot.fk(q)
    box: dict[str, Any] = {"name": "box", "shape": {"type": "box", "size": [0.1, 0.1, 0.1]}}
    box["position"] = (target.translation + np.array([0.0, 0.0, 0.1])).tolist()
    clear = ikplan.objective(robot, target, scene={"obstacles": [box]})
    plain = ikplan.objective(robot, target)
    assert clear(q) > plain(q) + 0.01
    far = np.array(robot.home)
    assert float(plain(far)) > 0.4
    assert clear(far) == pytest.approx(plain(far) + 0.3)  # the whole weight, wherever it is far


def test_candidates_outside_count_at_the_bound(robot: Robot) -> None:
    objective = ikplan.objective(robot, [0.4, 0.2, 0.5])
    beyond = objective.upper + 1.0
    assert objective(beyond) == objective(objective.upper)
    np.testing.assert_array_equal(objective.best_x, objective.upper)


def test_budget_counts_rows_and_ends_within_a_call(robot: Robot) -> None:
    objective = ikplan.objective(robot, [0.4, 0.2, 0.5], budget=7)
    X = np.random.default_rng(0).uniform(objective.lower, objective.upper, (10, 7))
    with pytest.raises(BudgetSpent):
        objective(X)
    assert (objective.spent, objective.remaining) == (7, 0)
    assert objective.best_f == ikplan.objective(robot, [0.4, 0.2, 0.5])(X[:7]).min()
    with pytest.raises(BudgetSpent):
        objective(X[:1])


@pytest.mark.parametrize("X", [[[0.0] * 6], [[[0.0] * 7]], [[np.nan] * 7], 0.0])
def test_wrong_candidates_are_named(robot: Robot, X: Any) -> None:
    with pytest.raises(InvalidRequest, match="candidates"):
        ikplan.objective(robot, [0.4, 0.2, 0.5])(X)


def test_solver_of_python_solves_poses_and_plans(robot: Robot) -> None:
    ikplan.register_solver("descent", descent)
    pose = robot.fk([0.3, 0.5, 0.2, -1.0, 0.4, 0.6, 0.1])
    raw = ikplan.solve_ik(robot, pose, method="descent", refine=False, population=50, iterations=20)
    assert raw.evaluations == 1000
    refined = ikplan.solve_ik(robot, pose, method="descent")
    assert refined.position_error < 1e-9
    reached = robot.fk(refined.q)
    assert np.linalg.norm(pin.log6(reached.inverse() * pose).vector) < 1e-8
    request = {
        "robot": "iiwa14",
        "path": {"waypoints": [{"position": [0.5, 0.1, 0.5]}, {"position": [0.4, 0.3, 0.5]}]},
        "ik": {"method": "descent"},
    }
    first, second = ikplan.plan(request), ikplan.plan(request)
    assert first.certificate.max_position_error is not None
    assert first.certificate.max_position_error < 1e-6
    np.testing.assert_array_equal(first.q, second.q)


def test_parameters_reach_the_function_and_are_checked(robot: Robot) -> None:
    steps = []

    def told(objective: PoseObjective, rng: np.random.Generator, step: float) -> None:
        steps.append(step)
        descent(objective, rng, step)

    step = Parameter(name="step", default=0.5, minimum=0.0, description="The first step.")
    ikplan.register_solver("told", told, parameters=[step])
    target = [0.4, 0.2, 0.5]
    ikplan.solve_ik(robot, target, method="told", params={"step": 0.25})
    assert steps == [0.25]
    with pytest.raises(InvalidRequest, match="stap"):
        ikplan.solve_ik(robot, target, method="told", params={"stap": 0.25})
    with pytest.raises(InvalidRequest, match="bounds"):
        ikplan.register_solver(
            "again", told, parameters=[step.model_copy(update={"name": "bounds"})]
        )


def test_name_that_is_taken_is_refused_or_replaced(robot: Robot) -> None:
    with pytest.raises(InvalidRequest, match="pso"):
        ikplan.register_solver("pso", descent)
    with pytest.raises(InvalidRequest, match="pso"):
        ikplan.register_solver("pso", descent, replace=True)
    calls = []
    ikplan.register_solver("mine", descent)
    ikplan.solve_ik(robot, [0.4, 0.2, 0.5], method="mine")

    def other(objective: PoseObjective, rng: np.random.Generator) -> None:
        calls.append(1)
        descent(objective, rng)

    with pytest.raises(InvalidRequest, match="replace=True"):
        ikplan.register_solver("mine", other)
    ikplan.register_solver("mine", other, replace=True)
    ikplan.solve_ik(robot, [0.4, 0.2, 0.5], method="mine")
    assert calls == [1]


def test_function_that_evaluates_nothing_is_an_error(robot: Robot) -> None:
    ikplan.register_solver("idle", lambda *_: None)
    with pytest.raises(InvalidRequest, match="without an evaluation"):
        ikplan.solve_ik(robot, [0.4, 0.2, 0.5], method="idle")


def test_answer_that_is_returned_counts(robot: Robot) -> None:
    q = np.array([0.3, 0.5, 0.2, -1.0, 0.4, 0.6, 0.1])
    ikplan.register_solver("knows", lambda *_: q)
    found = ikplan.solve_ik(robot, robot.fk(q), method="knows", refine=False)
    np.testing.assert_array_equal(found.q, q)
    assert found.evaluations == 1


def test_installed_packages_bring_solvers(monkeypatch: pytest.MonkeyPatch) -> None:
    point = EntryPoint("from-a-package", f"{__name__}:descent", registry.ENTRY_POINTS)
    monkeypatch.setattr(registry, "entry_points", lambda **_: [point])
    registry._installed.cache_clear()
    found = ikplan.ik.find_solver("from-a-package")
    assert (found.family, found.source) == ("outside", f"{__name__}:descent")
    assert "from-a-package" in [s.name for s in ikplan.ik.solvers()]
    broken = EntryPoint("broken", "no_such_module:solver", registry.ENTRY_POINTS)
    monkeypatch.setattr(registry, "entry_points", lambda **_: [broken])
    registry._installed.cache_clear()
    with pytest.raises(InvalidRequest, match="no_such_module"):
        ikplan.ik.solvers()
