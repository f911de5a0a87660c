"""Objectives against Pinocchio and the formulas, and the weights of Li et al."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

from ikplan.errors import InvalidRequest
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.objective import (
    ORIENTATION,
    POSITION,
    ROSENBROCK,
    SPHERE,
    WEIGHTED,
    evaluate,
    function_objective,
    objective_chain,
    pose_objective,
    wrist_objective,
)
from ikplan.ik.registry import find_solver
from ikplan.ik.weights import arm_length, fitness_weights
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.forward import forward
from ikplan.kinematics.target import Target, pose_target
from ikplan.kinematics.wrist import nearest_wrist
from ikplan.robots import Robot, load_robot

ROBOTS = ["iiwa14", "mh5", "dobot_magician", "eod_arm", "baxter_table7", "kinova_j2s6s200"]


@functools.cache
def robot_of(name: str) -> Robot:
    return load_robot(name)


@pytest.mark.parametrize("name", ROBOTS)
def test_objectives_are_the_formulas_on_pinocchios_pose(name: str) -> None:
    robot = robot_of(name)
    chain = arm_of(robot).chain
    rng = np.random.default_rng(0)
    for _ in range(10):
        target = robot.fk(robot.random_configuration(rng))
        q = robot.random_configuration(rng)
        pose = robot.fk(q)
        distance = np.linalg.norm(pose.translation - target.translation)
        rotation = np.linalg.norm(pose.rotation - target.rotation)
        expected = {
            POSITION: distance,
            ORIENTATION: rotation / np.linalg.norm(target.rotation),
            WEIGHTED: 1000.0 * distance + 0.0384 * rotation,
        }
        for kind, value in expected.items():
            objective = pose_objective(
                chain,
                target.rotation,
                target.translation,
                kind,
                weight_position=1000.0,
                weight_orientation=0.0384,
            )
            assert evaluate(objective, q) == pytest.approx(value, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("name", ["iiwa14", "dobot_magician"])
def test_an_objective_gives_its_chain_back(name: str) -> None:
    chain = arm_of(robot_of(name)).chain
    again = objective_chain(pose_objective(chain, np.eye(3), np.zeros(3)))
    for a, b in zip(again, chain, strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_decoupled_objective_is_zero_where_the_pose_is_met() -> None:
    robot = robot_of("iiwa14")
    wrist = arm_of(robot).wrist
    assert wrist is not None
    rng = np.random.default_rng(1)
    broken = 0
    for _ in range(200):
        q = robot.random_configuration(rng)
        pose = robot.fk(q)
        R, p = np.array(pose.rotation), np.array(pose.translation)
        plain = wrist_objective(wrist, R, p, q[4:], penalise=False)
        strict = wrist_objective(wrist, R, p, q[4:], penalise=True)
        assert evaluate(plain, q[:4].copy()) < 1e-14
        assert evaluate(strict, q[:4].copy()) < 1e-14
        x = robot.random_configuration(rng)[:4].copy()
        R_arm, _ = forward(wrist.arm, x)
        inside = nearest_wrist(wrist, R_arm, R, q[4:].copy(), np.empty(3))
        broken += not inside
        penalty = evaluate(strict, x) - evaluate(plain, x)
        assert penalty == pytest.approx(0.0 if inside else 1.0, abs=1e-14)
    assert 5 < broken < 150


def test_test_functions_by_hand() -> None:
    x = np.array([1.0, 2.0, -1.0])
    assert evaluate(function_objective(SPHERE), x) == 6.0
    assert evaluate(function_objective(ROSENBROCK), x) == 100.0 + 0.0 + 2500.0 + 1.0


@pytest.mark.parametrize(
    ("name", "millimetres"), [("eod_arm", 1173.3), ("baxter_table7", 1386.519), ("iiwa14", 1306.0)]
)
def test_arm_length_is_the_sum_of_the_tables(name: str, millimetres: float) -> None:
    assert 1000.0 * arm_length(arm_of(robot_of(name)).chain) == pytest.approx(millimetres, abs=1e-9)


def test_weights_of_the_eod_arm_lie_in_the_published_range() -> None:
    weights = fitness_weights(arm_of(robot_of("eod_arm")))
    assert weights.joint_range == pytest.approx(6.0 * np.pi)
    assert 0.5725 <= weights.lambda_p <= 0.5848
    assert 0.037666 <= weights.omega_rotation <= 0.039615
    assert weights.omega_position == 1000.0


def test_weights_of_the_baxter_arm() -> None:
    weights = fitness_weights(arm_of(robot_of("baxter_table7")))
    assert weights.joint_range == pytest.approx(19.0 * np.pi / 3.0)
    assert 0.7396 <= weights.lambda_p <= 0.7636
    assert weights.omega_rotation == pytest.approx(0.01656, rel=0.06)


def test_a_searcher_minimises_what_its_parameters_ask_for() -> None:
    robot = robot_of("eod_arm")
    arm = arm_of(robot)
    rng = np.random.default_rng(2)
    pose = robot.fk(robot.random_configuration(rng))
    target = pose_target(pose.translation, pose.rotation)
    q = robot.random_configuration(rng)
    here = robot.fk(q)
    distance = np.linalg.norm(here.translation - pose.translation)
    rotation = np.linalg.norm(here.rotation - pose.rotation)
    omega = fitness_weights(arm).omega_rotation
    solver = find_solver("bode-cs")

    def value(target: Target, **params: Any) -> float:
        searcher = Searcher(arm, solver, solver.check(params), 0)
        return evaluate(searcher.objective(target, robot.home), q)

    assert value(target, objective="position") == pytest.approx(distance)
    assert value(target, objective="orientation") == pytest.approx(rotation / np.sqrt(3.0))
    assert value(target, objective="bode-cs") == pytest.approx(1000 * distance + omega * rotation)
    weights = {"weight_position": 2.0, "weight_orientation": 3.0}
    assert value(target, **weights) == pytest.approx(2.0 * distance + 3.0 * rotation)
    assert value(pose_target(pose.translation)) == pytest.approx(distance)
    for name in ("orientation", "weighted", "bode-cs"):
        with pytest.raises(InvalidRequest) as caught:
            value(pose_target(pose.translation), objective=name)
        assert caught.value.field == "ik.params.objective"
