"""Plans that touch nothing: what is proven, what is refused, and what switches the check off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import InCollision, load_robot
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.retime import time_request
from ikplan.planning.repair_kinds import merged_document
from ikplan.robots import robot_from_urdf
from tests.two_joints import URDF

OFF = {"self_collision": False}


def box(position: Any, size: float | list[float] = 0.1, name: str = "box") -> dict[str, Any]:
    edges = [size] * 3 if isinstance(size, float) else size
    shape = {"type": "box", "size": edges}
    return {"name": name, "shape": shape, "position": [float(v) for v in position]}


def request(name: str, offset: list[float], **more: Any) -> dict[str, Any]:
    robot = load_robot(name)
    p = robot.fk(robot.home).translation + np.array(offset)
    path = {"waypoints": [{"position": p.tolist()}], "interpolation": "line"}
    return {"robot": name, "path": path, **more}


def tool_at(name: str, offset: list[float]) -> np.ndarray:
    robot = load_robot(name)
    return np.asarray(robot.fk(robot.home).translation + np.array(offset))


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_a_plan_is_proven_clear_of_the_arm_itself(name: str) -> None:
    plan = ikplan.plan(request(name, [0.0, 0.1, 0.05]))
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert clearance.pairs_checked > 10
    assert clearance.least is not None
    assert clearance.found is not None
    assert 0.0 < clearance.least <= clearance.found
    robot = load_robot(name)
    dense = [robot.clearance(q).distance for q in plan.q[::5]]
    assert clearance.least <= min(dense) + 5e-6
    assert clearance.self_.pairs_checked == clearance.pairs_checked
    assert clearance.scene.pairs_checked == 0


def test_switching_the_check_off_leaves_id_and_motion_as_they_were() -> None:
    on, off = request("ur5", [0.0, 0.1, 0.0]), request("ur5", [0.0, 0.1, 0.0], scene=OFF)
    checked, plain = ikplan.plan(on), ikplan.plan(off)
    assert plain.certificate.clearance is None
    assert checked.id != plain.id
    assert np.array_equal(checked.q, plain.q)
    assert ikplan.plan({**on, "scene": {}}).id == checked.id


def test_an_obstacle_beside_the_path_has_its_distance_in_the_certificate() -> None:
    place = tool_at("panda", [0.0, 0.1, -0.25])
    plan = ikplan.plan(request("panda", [0.0, 0.2, 0.0], scene={"obstacles": [box(place)]}))
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.scene.pair is not None
    assert "box" in clearance.scene.pair
    robot = load_robot("panda")
    scene = {"obstacles": [box(place)], "self_collision": False}
    dense = min(robot.clearance(q, scene).distance for q in plan.q[::3])
    assert clearance.scene.least is not None
    assert dense - 2e-3 <= clearance.scene.least <= dense + 5e-6


def test_a_start_in_an_obstacle_is_refused_with_the_pair() -> None:
    scene = {"obstacles": [box(tool_at("ur5", [0.0, 0.0, 0.0]))]}
    with pytest.raises(InCollision) as caught:
        ikplan.plan(request("ur5", [0.0, 0.2, 0.0], scene=scene))
    assert caught.value.waypoint == -1
    assert "box" in caught.value.pair
    assert caught.value.proven
    assert len(caught.value.q) == 6


def test_a_waypoint_in_an_obstacle_names_what_all_candidates_touch() -> None:
    place = tool_at("ur5", [0.0, 0.4, 0.0])
    scene = {"obstacles": [box(place, 0.2)]}
    document = request("ur5", [0.0, 0.4, 0.0], scene=scene)
    document["path"]["interpolation"] = "joint"
    with pytest.raises(InCollision) as caught:
        ikplan.plan(document)
    assert caught.value.waypoint == 0
    assert "box" in caught.value.pair
    assert "box" in caught.value.reason


def test_a_wall_across_a_line_is_named_with_the_place() -> None:
    scene = {"obstacles": [box(tool_at("ur5", [0.0, 0.1, 0.0]), [0.4, 0.02, 0.4], "wall")]}
    with pytest.raises(InCollision) as caught:
        ikplan.plan(request("ur5", [0.0, 0.2, 0.0], scene=scene))
    assert "wall" in caught.value.pair
    assert caught.value.waypoint == 0


def test_the_clearance_asked_for_is_kept() -> None:
    place = tool_at("panda", [0.0, 0.1, -0.25])
    scene = {"obstacles": [box(place)], "self_collision": False}
    document = request("panda", [0.0, 0.2, 0.0], scene=scene)
    clearance = ikplan.plan(document).certificate.clearance
    assert clearance is not None
    assert clearance.least is not None
    asked = {**document, "scene": {**scene, "clearance": clearance.least - 2e-3}}
    again = ikplan.plan(asked).certificate.clearance
    assert again is not None
    assert again.proven
    with pytest.raises(InCollision) as caught:
        ikplan.plan({**document, "scene": {**scene, "clearance": clearance.least + 0.2}})
    assert caught.value.depth > 0.0


def test_a_branch_in_contact_is_left_for_one_that_is_free() -> None:
    """With the elbow's usual place taken, the arm meets the waypoint in another branch."""
    robot = load_robot("ur5")
    target = robot.fk(np.array([0.3, -1.2, 1.6, -2.0, -1.57, 0.0]))
    pose = {"position": target.translation.tolist()}
    document: dict[str, Any] = {
        "robot": "ur5",
        "start": "free",
        "path": {"waypoints": [pose], "interpolation": "joint", "orientation_free": "all"},
    }
    first = ikplan.plan(document)
    elbow = robot.clearance(first.q[0], {"obstacles": [box([0, 0, 3.0], 0.05)]})
    assert elbow.distance > 0.0
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(first.q[0]))
    place = (robot.T_universe_base.inverse() * data.oMi[3]).translation
    scene = {"obstacles": [box(place, 0.08, "post")]}
    second = ikplan.plan({**document, "scene": scene})
    assert not np.allclose(second.q[0], first.q[0], atol=1e-2)
    assert second.certificate.clearance is not None
    assert second.certificate.clearance.proven
    assert robot.clearance(first.q[0], scene).distance <= 0.0


def test_timings_are_checked_only_where_a_scene_is_given() -> None:
    robot = load_robot("ur5")
    a = robot.home
    b = a + np.array([0.6, 0.0, 0.0, 0.0, 0.0, 0.0])
    document: dict[str, Any] = {"robot": "ur5", "waypoints": [a.tolist(), b.tolist()]}
    assert time_request(document).certificate.clearance is None
    far = time_request({**document, "scene": {}}).certificate.clearance
    assert far is not None
    assert far.proven
    post = box(robot.fk(0.5 * (a + b)).translation, 0.05, "post")
    with pytest.raises(InCollision) as caught:
        time_request({**document, "scene": {"obstacles": [post]}})
    assert caught.value.time is not None
    assert "post" in caught.value.pair


def test_a_robot_without_bodies_says_so() -> None:
    robot = robot_from_urdf(URDF, name="two")
    plan = ikplan.plan(
        {
            "robot": "two",
            "path": {
                "waypoints": [{"position": robot.fk(robot.home + 0.1).translation.tolist()}],
                "orientation_free": "all",
            },
        },
        robot=robot,
    )
    assert plan.certificate.clearance is not None
    assert not plan.certificate.clearance.proven
    assert plan.certificate.clearance.pairs_checked == 0
    assert plan.certificate.clearance.unchecked


def test_a_pose_with_a_scene_is_solved_in_a_branch_that_is_free() -> None:
    robot = load_robot("ur5")
    pose = robot.fk(np.array([0.3, -1.2, 1.6, -2.0, -1.57, 0.0]))
    document = {"robot": "ur5", "position": pose.translation.tolist()}
    first = solve_ik_request(document)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(first.q))
    elbow = (robot.T_universe_base.inverse() * data.oMi[3]).translation
    scene = {"obstacles": [box(elbow, 0.08, "post")]}
    second = solve_ik_request({**document, "scene": scene})
    assert robot.clearance(first.q, scene).distance <= 0.0
    assert robot.clearance(second.q, scene).distance > 0.0
    assert np.linalg.norm(robot.fk(second.q).translation - pose.translation) < 1e-6
    around = {"obstacles": [box(pose.translation, 0.3, "block")]}
    with pytest.raises(InCollision) as caught:
        solve_ik_request({**document, "scene": around})
    assert "block" in caught.value.pair


def test_solve_ik_checks_only_where_a_scene_is_given() -> None:
    robot = load_robot("ur5")
    pose = robot.fk(np.array([0.3, -1.2, 1.6, -2.0, -1.57, 0.0]))
    first = ikplan.solve_ik(robot, pose)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.configuration(first.q))
    elbow = (robot.T_universe_base.inverse() * data.oMi[3]).translation
    scene: dict[str, Any] = {"obstacles": [box(elbow, 0.08, "post")]}
    assert robot.clearance(first.q, scene).distance <= 0.0
    second = ikplan.solve_ik(robot, pose, scene=scene)
    assert robot.clearance(second.q, scene).distance > 0.0
    assert np.linalg.norm(robot.fk(second.q).translation - pose.translation) < 1e-6
    assert second.orientation_error is not None
    assert second.orientation_error < 1e-6
    far = ikplan.solve_ik(robot, pose, scene={"obstacles": [box([0.0, 0.0, 3.0])]})
    assert np.array_equal(far.q, first.q)
    around = {"obstacles": [box(pose.translation, 0.3, "block")]}
    with pytest.raises(InCollision) as caught:
        ikplan.solve_ik(robot, pose, scene=around)
    assert "block" in caught.value.pair
    with pytest.raises(ikplan.InvalidRequest) as wrong:
        ikplan.solve_ik(robot, pose, scene={"obstacels": []})
    assert wrong.value.field == "obstacels"


def test_a_clearance_that_cannot_be_kept_has_a_smaller_one_as_its_repair() -> None:
    post = tool_at("ur5", [0.0, 0.15, -0.2])
    scene = {"obstacles": [box(post)], "clearance": 0.3, "self_collision": False}
    document = request("ur5", [0.0, 0.2, 0.0], scene=scene)
    with pytest.raises(InCollision) as caught:
        ikplan.plan(document)
    changes = [repair["change"] for repair in caught.value.repairs]
    (smaller,) = [change["scene"]["clearance"] for change in changes if "scene" in change]
    assert 0.0 <= smaller < 0.3
    plan = ikplan.plan({**document, "scene": {**scene, "clearance": smaller}})
    assert plan.certificate.clearance is not None
    assert plan.certificate.clearance.proven


def test_every_repair_of_a_path_through_an_obstacle_is_planned() -> None:
    low = tool_at("ur5", [0.0, 0.15, -0.02])
    scene = {"obstacles": [box(low, [0.05, 0.05, 0.05])], "self_collision": False}
    document = request("ur5", [0.0, 0.3, 0.0], scene=scene)
    with pytest.raises(InCollision) as caught:
        ikplan.plan(document)
    assert caught.value.repairs
    for repair in caught.value.repairs:
        ikplan.plan(merged_document(document, repair["change"]))
