"""Planning around obstacles, held to dense searches and meshes; studies in benchmarks.collision."""

from __future__ import annotations

import numpy as np
import pytest

import ikplan
from benchmarks.collision.bodies import body_study
from benchmarks.collision.helices import helix_costs
from benchmarks.collision.lines import line_study
from benchmarks.collision.oracle import Oracle
from benchmarks.collision.window import window_cases, window_study
from benchmarks.planning.measure import pose_document
from ikplan import load_robot
from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.scene.model import collision_model


@pytest.mark.parametrize("free_start", [False, True])
def test_lines_beside_boxes_are_planned_where_a_dense_search_finds_a_way(free_start: bool) -> None:
    """What is followed in contact only is refused with the pair."""
    study = line_study(load_robot("ur5"), 8, free_start=free_start)
    assert study.free > 0
    assert study.lost == []
    assert study.held > 0
    assert study.unnamed == []
    assert study.named > 0


def test_a_redundant_arm_dodges_the_frame_of_a_window() -> None:
    """What is refused, a dense search over the self-motion along the line does not pass either."""
    study = window_study(load_robot("panda"), 5)
    assert study.held > study.planned > 0
    assert study.refused
    assert study.lost == []
    assert study.open_planned == study.open > 0
    assert min(study.least) > 0.0


@pytest.mark.parametrize("window", [5, 9])
def test_windows_that_few_ways_lead_through_are_passed(window: int) -> None:
    """A ladder over points of the line finds no way through either."""
    robot = load_robot("iiwa14")
    request = window_cases(robot, window + 1)[window]
    oracle = Oracle(robot, collision_model(robot, parse(Scene, request["scene"])))
    plan = ikplan.plan(request, robot=robot)
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert min(float(oracle.distances(q).min()) for q in plan.q[::4]) > 0.0
    assert np.array_equal(ikplan.plan(request, robot=robot).q, plan.q)


@pytest.mark.parametrize("window", [5, 9])
def test_a_line_in_many_parts_leads_through_a_window_as_in_one(window: int) -> None:
    """Followed from point to point, the arm swings; where that is not to be shortened, around."""
    robot = load_robot("iiwa14")
    request = window_cases(robot, window + 1)[window]
    goal = request["path"]["waypoints"][0]
    begin, end = robot.fk(np.array(request["start"])).translation, np.array(goal["position"])
    lengths, durations = [], []
    for parts in (1, 100):
        shares = np.linspace(0.0, 1.0, parts + 1)[1:, None]
        points = (begin + shares * (end - begin)).tolist()
        path = {**request["path"], "waypoints": [{**goal, "position": p} for p in points]}
        plan = ikplan.plan({**request, "path": path}, robot=robot)
        assert plan.certificate.clearance is not None
        assert plan.certificate.clearance.proven
        lengths.append(float(np.linalg.norm(np.diff(plan.trajectory.q, axis=0), axis=1).sum()))
        durations.append(plan.duration)
    assert lengths[1] < 1.4 * lengths[0]
    assert durations[1] < 1.8 * durations[0]


def test_a_dodged_motion_is_free_of_contact_by_coal() -> None:
    robot = load_robot("panda")
    request = window_cases(robot, 1)[0]
    oracle = Oracle(robot, collision_model(robot, parse(Scene, request["scene"])))
    plan = ikplan.plan(request, robot=robot)
    least = min(float(oracle.distances(q).min()) for q in plan.q[::4])
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.least is not None
    assert 0.0 < clearance.least <= least


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_no_contact_of_the_meshes_is_missed_by_the_bodies(name: str) -> None:
    study = body_study(name, 300)
    assert study.touching > 30
    assert study.missed == 0
    assert study.alarm_share < 0.03


def test_self_collision_leaves_a_helix_that_is_free_as_it_is() -> None:
    cost = helix_costs(0, ("B",))[0]
    assert cost.proven
    assert cost.same


def test_a_wider_check_is_that_of_a_larger_clearance() -> None:
    robot, rng = load_robot("panda"), np.random.default_rng(2)
    model = collision_model(robot)
    q = np.array([robot.random_configuration(rng) for _ in range(200)])
    checker = CollisionChecker(robot, model)
    wider = checker.wider(0.05)
    gaps = np.array([checker.least_gap(row)[0] for row in q])
    assert np.array_equal(checker.free(q), gaps > 0.0)
    assert np.array_equal(wider.free(q), gaps > 0.05)
    assert (wider.free(q) != checker.free(q)).any()


def test_a_joint_leg_goes_to_a_branch_that_its_straight_motion_reaches_freely() -> None:
    robot = load_robot("ur5")
    T = robot.fk(robot.home)
    begin = T.translation + np.array([0.0, 0.45, 0.0])
    post = {
        "name": "post",
        "shape": {"type": "box", "size": [0.08, 0.08, 0.8]},
        "position": [0.5, 0.27, 0.4],
    }
    request = {
        "robot": "ur5",
        "start": robot.home.tolist(),
        "path": {
            "waypoints": [
                pose_document(T.rotation, begin),
                pose_document(T.rotation, begin + np.array([-0.05, -0.08, 0.0])),
            ],
            "interpolation": "line",
            "approach": "joint",
        },
    }
    checker = CollisionChecker(robot, collision_model(robot, parse(Scene, {"obstacles": [post]})))
    nearest = ikplan.plan(request | {"scene": {"self_collision": False}})
    met = checker.first_contact(nearest.q)
    assert met is not None
    assert "post" in met.pair
    plan = ikplan.plan(request | {"scene": {"obstacles": [post]}})
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert checker.first_contact(plan.q) is None
