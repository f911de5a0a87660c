"""Moves around obstacles: where they end, that they are free, what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import InCollision, InvalidRequest, Unreachable, load_robot
from tests.moves.cells import box, moving, nearest_bodies, pose, post, turned, window

ROBOTS = ["ur5", "panda"]


@pytest.mark.parametrize("name", ROBOTS)
def test_a_move_goes_around_a_post_and_is_proven(name: str) -> None:
    robot = load_robot(name)
    goal = turned(robot, 1.6)
    scene = {"obstacles": [post(robot)]}
    plan = ikplan.move(name, robot.home, goal, scene, budget_s=300.0)
    assert np.allclose(plan.q[0], robot.home, atol=1e-9)
    assert np.allclose(plan.q[-1], goal, atol=1e-9)
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert clearance.least is not None
    assert 0.0 < clearance.least <= nearest_bodies(plan, scene) + 5e-6
    (report,) = plan.stats.moves
    assert report.samples > 0
    assert report.least_length == pytest.approx(1.6)
    assert report.least_length < report.length < report.found_length


@pytest.mark.parametrize("name", ROBOTS)
def test_a_straight_motion_is_taken_where_it_is_free(name: str) -> None:
    robot = load_robot(name)
    goal = turned(robot, 0.5)
    plan = ikplan.move(name, robot.home, goal, {"obstacles": [post(robot, 1.6)]})
    (report,) = plan.stats.moves
    assert report.samples == report.corners == report.stops == 0
    assert report.length == pytest.approx(0.5)
    across = plan.q - robot.home - np.outer(plan.q[:, 0] - robot.home[0], np.eye(robot.dof)[0])
    assert np.abs(across).max() < 1e-9


def test_a_window_in_a_wall_is_found() -> None:
    robot = load_robot("ur5")
    scene = {"obstacles": window(robot)}
    plan = ikplan.move("ur5", turned(robot, 0.2), turned(robot, 1.4), scene, budget_s=300.0)
    assert plan.certificate.clearance is not None
    assert plan.certificate.clearance.proven
    assert plan.stats.moves[0].samples > 0
    assert nearest_bodies(plan, scene) > 0.0


def test_the_same_move_is_the_same_to_the_byte() -> None:
    robot = load_robot("ur5")
    request = moving(
        "ur5",
        [{"type": "move", "q": turned(robot, 1.6).tolist()}],
        scene={"obstacles": [post(robot)]},
    )
    one, two = ikplan.plan(request), ikplan.plan({**request, "budget_s": 200.0})
    assert one.id == two.id
    assert one.q.tobytes() == two.q.tobytes()
    assert one.stats.moves == two.stats.moves


def test_the_effort_and_the_seed_are_part_of_the_id_and_no_effort_is_not() -> None:
    robot = load_robot("ur5")
    request = moving("ur5", [{"type": "move", "q": robot.home.tolist()}])

    def identity(**ik: Any) -> str:
        return ikplan.PlanRequest.model_validate({**request, "ik": ik}).content_hash()

    assert len({identity(), identity(effort=20_000), identity(effort=10), identity(seed=1)}) == 4
    assert identity(effort=None) == identity()


def test_a_start_in_contact_is_refused_and_not_repaired() -> None:
    robot = load_robot("ur5")
    scene = {"obstacles": [box("crate", robot.fk(robot.home).translation, (0.1, 0.1, 0.1))]}
    with pytest.raises(InCollision) as caught:
        ikplan.move("ur5", None, turned(robot, 1.0), scene)
    assert caught.value.waypoint == -1
    assert caught.value.proven
    assert "crate" in caught.value.pair


def test_a_goal_in_contact_is_proven_to_be() -> None:
    robot = load_robot("ur5")
    goal = turned(robot, 1.0)
    scene = {"obstacles": [box("crate", robot.fk(goal).translation, (0.1, 0.1, 0.1))]}
    with pytest.raises(InCollision) as caught:
        ikplan.move("ur5", None, goal, scene)
    assert caught.value.waypoint == 0
    assert caught.value.proven
    assert "crate" in caught.value.pair


def test_no_way_within_the_effort_is_not_called_impossible() -> None:
    robot = load_robot("ur5")
    scene = {"obstacles": window(robot, opening=0.3)}
    refused = []
    for seed in range(4):
        try:
            ikplan.move("ur5", turned(robot, 0.2), turned(robot, 1.4), scene, effort=1, seed=seed)
        except InCollision as verdict:
            refused.append(verdict)
    assert refused
    for refusal in refused:
        assert not refusal.proven
        assert not {"outer", "below", "above"}.isdisjoint(refusal.pair)
        assert "does not prove" in str(refusal)
        assert refusal.waypoint == 0


def test_a_move_to_a_pose_may_end_in_any_configuration_that_meets_it() -> None:
    robot = load_robot("panda")
    goal, scene = pose(robot, turned(robot, 1.2)), {"obstacles": [post(robot, 0.6)]}
    plan = ikplan.move("panda", None, goal, scene, budget_s=300.0)
    T = robot.fk(plan.q[-1])
    assert np.allclose(T.translation, goal["position"], atol=1e-6)
    assert plan.certificate.max_position_error is not None
    assert plan.certificate.max_position_error < 1e-6
    # By its self-motion the arm reaches the pose on a shorter way than the configuration that the
    # pose was made of.
    one = ikplan.move("panda", None, turned(robot, 1.2), scene, budget_s=300.0)
    assert plan.stats.moves[0].length < 0.8 * one.stats.moves[0].length


def test_an_se3_is_a_pose() -> None:
    robot = load_robot("ur5")
    T = robot.fk(turned(robot, 0.4))
    assert isinstance(T, pin.SE3)
    plan = ikplan.move("ur5", None, T)
    assert np.allclose(robot.fk(plan.q[-1]).homogeneous, T.homogeneous, atol=1e-6)


def test_of_several_goals_the_nearest_free_one_is_gone_to() -> None:
    robot = load_robot("ur5")
    goals = [turned(robot, angle) for angle in (1.5, -0.6, 0.9)]
    for order in ([0, 1, 2], [2, 0, 1]):
        plan = ikplan.move("ur5", None, [goals[k] for k in order])
        assert np.allclose(plan.q[-1], goals[1], atol=1e-9)
    in_the_way = box("crate", robot.fk(goals[1]).translation, (0.08, 0.08, 0.08))
    plan = ikplan.move("ur5", None, goals, {"obstacles": [in_the_way]})
    assert np.allclose(plan.q[-1], goals[2], atol=1e-9)


def test_poses_and_joint_values_may_stand_side_by_side() -> None:
    robot = load_robot("ur5")
    far = {"position": [9.0, 0.0, 0.0]}
    plan = ikplan.move("ur5", None, [far, turned(robot, 0.7), pose(robot, turned(robot, 0.3))])
    assert np.allclose(plan.q[-1], turned(robot, 0.3), atol=1e-6)
    with pytest.raises(Unreachable):
        ikplan.move("ur5", None, [far, far])


def test_a_tool_path_after_a_move_begins_in_a_branch_that_the_move_reaches() -> None:
    robot = load_robot("panda")
    at = pose(robot, turned(robot, 1.2))
    down = {**at, "position": [at["position"][0], at["position"][1], at["position"][2] - 0.1]}
    scene = {"obstacles": [post(robot, 0.6)]}
    segments = [
        {"type": "move", "to": at},
        {"type": "line", "to": down},
        {"type": "move", "to": at},
    ]
    plan = ikplan.plan(moving("panda", segments, scene=scene))
    assert plan.certificate.clearance is not None
    assert plan.certificate.clearance.proven
    assert plan.certificate.max_path_deviation is not None
    assert plan.certificate.max_path_deviation < 1e-4
    assert [report.field for report in plan.stats.moves] == ["path.segments[0]", "path.segments[2]"]
    assert len(plan.waypoints.q) == 3


def test_a_tool_path_cannot_follow_a_move_to_any_of_several() -> None:
    robot = load_robot("ur5")
    goals = [{"q": turned(robot, angle).tolist()} for angle in (0.2, 0.4)]
    line = {"type": "line", "to": pose(robot, turned(robot, 0.5))}
    with pytest.raises(InvalidRequest, match="tool path cannot follow") as caught:
        ikplan.plan(moving("ur5", [{"type": "move", "any": goals}, line]))
    assert caught.value.field == "path.segments[0].any"
    back = {"type": "joint", "q": turned(robot, 0.3).tolist()}
    plan = ikplan.plan(moving("ur5", [{"type": "move", "any": goals}, back, line]))
    assert np.allclose(plan.waypoints.q[0], turned(robot, 0.2), atol=1e-9)


def test_a_path_may_be_approached_by_a_move() -> None:
    robot = load_robot("panda")
    scene = {"obstacles": [post(robot, 0.6)]}
    first, second = pose(robot, turned(robot, 1.2)), pose(robot, turned(robot, 1.3))
    path = {"waypoints": [first, second], "interpolation": "line", "approach": "move"}
    request = {"robot": "panda", "path": path, "scene": scene, "budget_s": 300.0}
    plan = ikplan.plan(request)
    assert plan.certificate.clearance is not None
    assert plan.certificate.clearance.proven
    (report,) = plan.stats.moves
    assert report.field == "path.waypoints[0]"
    with pytest.raises(InCollision):
        ikplan.plan(
            {**request, "path": {**path, "approach": "joint"}, "start": "free"}
            | {"scene": {"obstacles": [box("crate", first["position"], (0.3, 0.3, 0.3))]}}
        )


def test_without_checks_a_move_is_straight() -> None:
    robot = load_robot("ur5")
    scene = {"self_collision": False}
    plan = ikplan.move("ur5", None, turned(robot, 1.0), scene)
    assert plan.certificate.clearance is None
    assert plan.stats.moves[0].length == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("segment", "words"),
    [
        ({"type": "move"}, "exactly one"),
        ({"type": "move", "q": [0.0], "to": {"position": [0, 0, 0]}}, "exactly one"),
        ({"type": "move", "any": []}, "at least 1"),
    ],
)
def test_a_move_has_one_target(segment: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidRequest, match=words):
        ikplan.plan(moving("ur5", [segment]))


@pytest.mark.parametrize("turns", [1.7, -1.9])
def test_an_arc_of_nearly_two_turns_after_a_move_begins_a_turn_earlier(turns: float) -> None:
    robot = load_robot("ur5")
    begin = pose(robot, turned(robot, np.copysign(0.3, turns)))
    angle = turns * 2.0 * np.pi
    arc = {
        "type": "arc", "centre": [0.0, 0.0, begin["position"][2]], "angle": angle,
        "orientation": "follow",
    }  # fmt: skip
    scene = {"obstacles": [box("far", [0, 0, 5], [1, 1, 1])]}
    by_move = ikplan.plan(moving("ur5", [{"type": "move", "to": begin}, arc], scene=scene))
    assert by_move.q[-1, 0] - by_move.waypoints.q[0][0] == pytest.approx(angle, abs=1e-3)
    by_joint = ikplan.plan(moving("ur5", [{"type": "joint", "to": begin}, arc], scene=scene))
    assert np.allclose(by_move.waypoints.q, by_joint.waypoints.q, atol=1e-3)
    path = {"begin": begin, "segments": [arc], "approach": "move"}
    approached = ikplan.plan({"robot": "ur5", "path": path, "scene": scene, "budget_s": 300.0})
    assert np.allclose(approached.waypoints.q, by_move.waypoints.q, atol=1e-3)
