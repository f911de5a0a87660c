"""How crowded configurations are, and that as a term of what the searches minimise."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.papers.clearance import avoidance_cases, compare
from ikplan import InvalidRequest, load_robot
from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.ik.crowding import crowding, crowding_of_rows, surroundings
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.objective import evaluate, pose_objective
from ikplan.ik.registry import find_solver
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.scene.contacts import Contacts
from ikplan.scene.model import collision_model
from ikplan.scene.poses import carrier_poses

ROBOT = load_robot("panda")
BALL = {"name": "ball", "shape": {"type": "sphere", "radius": 0.1}, "position": [0.4, 0.3, 0.5]}
MODEL = collision_model(ROBOT, parse(Scene, {"obstacles": [BALL], "clearance": 0.005}))
CHECKER = CollisionChecker(ROBOT, MODEL)


BY_PAIR = [Contacts(MODEL.bodies, MODEL.pairs[k : k + 1]) for k in range(len(MODEL.pairs))]


def crowding_by_coal(q: NDArray[np.float64], reach: float) -> float:
    """The definition, with coal's distance of every pair of bodies."""
    total = 0.0
    for contacts in BY_PAIR:
        nearest = contacts.nearest(*carrier_poses(ROBOT, q))
        assert nearest is not None
        if nearest.distance <= MODEL.clearance:
            return 1.0
        total += max(0.0, 1.0 - (nearest.distance - MODEL.clearance) / reach) ** 2
    return total / (1.0 + total)


def test_the_crowding_is_that_of_its_definition_with_coals_distances() -> None:
    rng = np.random.default_rng(1)
    around = surroundings(CHECKER.arrays(None))
    q = np.array([ROBOT.random_configuration(rng) for _ in range(60)])
    found = np.empty(len(q))
    crowding_of_rows(around, q, found)
    expected = [crowding_by_coal(row, around.reach) for row in q]
    assert found == pytest.approx(np.array(expected), abs=1e-4)
    assert 5 < np.sum(found == 1.0) < 40
    assert np.ptp(found[found < 1.0]) > 0.1


def test_the_term_fades_in_as_the_pose_is_met_and_is_its_weight_far_away() -> None:
    rng = np.random.default_rng(2)
    chain = arm_of(ROBOT).chain
    around = surroundings(CHECKER.arrays(None), near=0.3, weight=0.5)
    far = near = 0
    for _ in range(60):
        q = ROBOT.random_configuration(rng)
        T = ROBOT.fk(ROBOT.clip(q + rng.normal(scale=rng.choice([0.1, 0.5]), size=ROBOT.dof)))
        plain = pose_objective(chain, T.rotation, T.translation)
        value = evaluate(plain, q)
        term = evaluate(plain._replace(around=around), q) - value
        if value > 0.3:
            assert term == pytest.approx(0.5)
            far += 1
        else:
            clear = (1.0 - value / 0.3) * (1.0 - crowding(around, q))
            assert term == pytest.approx(0.5 * (1.0 - clear), abs=1e-6)
            near += 1
    assert min(far, near) > 5


@pytest.mark.parametrize(
    ("objective", "metre"),
    [("weighted", 2.0), ("position", 1.0), ("orientation", 1.0), ("bode-cs", 1000.0)],
)
def test_the_term_is_in_the_unit_of_the_objective(objective: str, metre: float) -> None:
    solver = find_solver("ik-ba")
    values = solver.check({"objective": objective, "weight_position": 2.0})
    searcher = Searcher(arm_of(ROBOT), solver, values, 0)
    searcher.around = surroundings(CHECKER.arrays(None))
    T = ROBOT.fk(ROBOT.home)
    around = searcher.objective(pose_target(T.translation, T.rotation), ROBOT.home).around
    assert around is not None
    assert around.weight == metre * searcher.around.weight
    assert around.near == metre * searcher.around.near


def test_searches_with_the_term_find_configurations_that_are_less_crowded() -> None:
    """A reduced run of the comparison in benchmarks.papers.clearance."""
    robot = load_robot("iiwa14")
    cases = avoidance_cases(robot, 30, 1)
    rows = compare(robot, cases, population=30, iterations=100, methods=("ik-ba", "pso"))
    assert len(rows) == 2
    for row in rows:
        assert row.with_term.free.sum() > row.without.free.sum()
        assert np.array_equal(row.with_term.evaluations, row.without.evaluations)
    assert np.concatenate([row.gains for row in rows]).mean() > 0.0


def test_a_search_without_the_wrist_takes_no_term() -> None:
    robot = load_robot("iiwa14")
    arm, solver = arm_of(robot), find_solver("ik-ba")
    searcher = Searcher(arm, solver, solver.check({"decouple": True}), 0)
    model = collision_model(robot, parse(Scene, {}))
    searcher.around = surroundings(CollisionChecker(robot, model).arrays(None))
    T = robot.fk(robot.home)
    with pytest.raises(InvalidRequest, match="decouple"):
        searcher.objective(pose_target(T.translation, T.rotation), robot.home)
