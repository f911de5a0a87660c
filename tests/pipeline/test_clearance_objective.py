"""``ik.objective: "clearance"``: what it chooses, what it leaves as it was, where it is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

import ikplan
from ikplan import InvalidRequest, PlanRequest, Robot, load_robot
from ikplan.pipeline.poses import solve_ik_request
from tests.two_joints import URDF

CLEAR: dict[str, Any] = {"objective": "clearance"}
ROBOT = load_robot("iiwa14")


def boxes(rng: np.random.Generator, count: int) -> list[dict[str, Any]]:
    """Boxes around the arm, away from its base."""
    found = []
    for k in range(count):
        angle, radius = rng.uniform(-np.pi, np.pi), rng.uniform(0.4, 0.8)
        place = [radius * np.cos(angle), radius * np.sin(angle), rng.uniform(0.0, 0.9)]
        shape = {"type": "box", "size": rng.uniform(0.05, 0.2, 3).tolist()}
        found.append({"name": f"box {k}", "shape": shape, "position": place})
    return found


def free_configuration(
    robot: Robot, scene: dict[str, Any], rng: np.random.Generator
) -> NDArray[np.float64]:
    samples = (robot.random_configuration(rng) for _ in range(1000))
    return next(q for q in samples if robot.clearance(q, scene).distance > 0.02)


def pose_of(q: NDArray[np.float64]) -> dict[str, Any]:
    x = pin.SE3ToXYZQUAT(ROBOT.fk(q)).tolist()
    return {"position": x[:3], "quaternion_xyzw": x[3:]}


def joint_path(seed: int, count: int = 3, **ik: Any) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    scene = {"obstacles": boxes(rng, 5)}
    poses = [pose_of(free_configuration(ROBOT, scene, rng)) for _ in range(count)]
    path = {"waypoints": poses, "interpolation": "joint"}
    start = free_configuration(ROBOT, scene, rng).tolist()
    return {"robot": "iiwa14", "start": start, "path": path, "scene": scene, "ik": ik}


def bytes_of(plan: ikplan.Plan) -> str:
    return plan.model_dump_json(exclude={"stats"})


def test_solutions_keep_farther_from_bodies_in_the_mean() -> None:
    rng = np.random.default_rng(4)
    distances = []
    for _ in range(15):
        scene = {"obstacles": boxes(rng, 6)}
        pose = ROBOT.fk(free_configuration(ROBOT, scene, rng))
        found = [
            ikplan.solve_ik(ROBOT, pose, scene=scene, objective=objective)
            for objective in ("motion", "clearance")
        ]
        assert max(solution.position_error for solution in found) < 1e-6
        distances.append([ROBOT.clearance(solution.q, scene).distance for solution in found])
    motion, clearance = np.array(distances).T
    assert clearance.mean() > 1.2 * motion.mean()
    assert np.minimum(clearance, 0.1).mean() >= np.minimum(motion, 0.1).mean()
    assert np.sum(clearance > motion + 1e-3) > np.sum(clearance < motion - 1e-3)


@pytest.mark.parametrize("method", ["ik-ba", "lm"])
def test_an_elbow_with_room_goes_away_from_a_body_beside_it(method: str) -> None:
    q = np.array([0.0, 0.6, 0.0, -1.4, 0.0, 0.8, 0.0])
    data = ROBOT.model.createData()
    pin.forwardKinematics(ROBOT.model, data, ROBOT.configuration(q))
    elbow = data.oMi[4].translation + np.array([0.0, 0.15, 0.0])
    shape = {"type": "sphere", "radius": 0.05}
    ball = {"name": "ball", "shape": shape, "position": elbow.tolist()}
    scene = {"obstacles": [ball], "self_collision": False}
    pose = ROBOT.fk(q)
    near, clear = (
        ikplan.solve_ik(ROBOT, pose, start=q, method=method, scene=scene, objective=objective)
        for objective in ("motion", "clearance")
    )
    at_start, away = (ROBOT.clearance(x.q, scene).distance for x in (near, clear))
    assert 0.0 < at_start < 0.05
    assert away > 0.1


def test_the_same_request_gives_the_same_bytes() -> None:
    request = joint_path(3, **CLEAR)
    assert bytes_of(ikplan.plan(request)) == bytes_of(ikplan.plan(request))
    pose = {"robot": "iiwa14", **request["path"]["waypoints"][0], "scene": request["scene"]}
    answers = [solve_ik_request({**pose, "ik": CLEAR}).model_dump_json() for _ in range(2)]
    assert answers[0] == answers[1]


def test_only_clearance_enters_the_id() -> None:
    plain = PlanRequest(**joint_path(3))
    assert PlanRequest(**joint_path(3, objective="motion")).content_hash() == plain.content_hash()
    assert PlanRequest(**joint_path(3, **CLEAR)).content_hash() != plain.content_hash()


def test_plans_are_proven_to_keep_farther_from_bodies() -> None:
    least = []
    for seed in range(14):
        plans = [ikplan.plan(joint_path(seed, **ik)) for ik in ({}, CLEAR)]
        proofs = [plan.certificate.clearance for plan in plans]
        assert all(proof is not None and proof.proven for proof in proofs)
        least.append([proof.least for proof in proofs if proof is not None])
    motion, clearance = np.array(least, dtype=np.float64).T
    assert clearance.mean() > 1.2 * motion.mean()
    assert np.sum(clearance > motion + 1e-3) > np.sum(clearance < motion - 1e-3)


def test_waypoint_by_waypoint_every_motion_is_free() -> None:
    plan = ikplan.plan(joint_path(3, elongation="greedy", **CLEAR))
    assert plan.certificate.clearance is not None
    assert plan.certificate.clearance.proven


def test_a_batch_answers_as_each_pose_alone() -> None:
    rng = np.random.default_rng(8)
    scene = {"obstacles": boxes(rng, 4)}
    poses = [ROBOT.fk(free_configuration(ROBOT, scene, rng)) for _ in range(4)]
    batch = ikplan.solve_ik_batch(ROBOT, poses, scene=scene, objective="clearance")
    assert batch.solved.all()
    for pose, q in zip(poses, batch.q, strict=True):
        alone = ikplan.solve_ik(ROBOT, pose, method="lm", scene=scene, objective="clearance")
        assert np.array_equal(alone.q, q)


@pytest.mark.parametrize(
    ("scene", "match"),
    [(None, "give a scene"), ({"self_collision": False}, "give a scene")],
)
def test_without_bodies_it_is_refused(scene: dict[str, Any] | None, match: str) -> None:
    with pytest.raises(InvalidRequest, match=match) as caught:
        ikplan.solve_ik(ROBOT, ROBOT.fk(ROBOT.home), scene=scene, objective="clearance")
    assert caught.value.field == "ik.objective"
    assert caught.value.allowed == ["motion"]
    with pytest.raises(InvalidRequest, match=match):
        ikplan.solve_ik_batch(ROBOT, [ROBOT.fk(ROBOT.home)], scene=scene, objective="clearance")
    request = {"robot": "iiwa14", "position": [0.4, 0.0, 0.6], "scene": scene, "ik": CLEAR}
    with pytest.raises(InvalidRequest, match=match):
        solve_ik_request(request)


def test_a_robot_without_shapes_is_refused_with_its_links() -> None:
    robot = ikplan.robots.robot_from_urdf(URDF)
    with pytest.raises(InvalidRequest, match="without a shape"):
        ikplan.solve_ik(robot, robot.fk(robot.home), scene={}, objective="clearance")


@pytest.mark.parametrize(
    "path",
    [
        {"waypoints": [{"position": [0.4, 0.2, 0.6]}], "interpolation": "line"},
        {"segments": [{"type": "move", "to": {"position": [0.4, 0.2, 0.6]}}]},
    ],
)
def test_paths_on_which_it_would_not_act_are_refused(path: dict[str, Any]) -> None:
    with pytest.raises(InvalidRequest, match="tool path or a move") as caught:
        ikplan.plan({"robot": "iiwa14", "path": path, "ik": CLEAR})
    assert caught.value.field == "ik.objective"


def test_another_objective_is_refused_with_the_choices() -> None:
    with pytest.raises(InvalidRequest) as caught:
        ikplan.solve_ik(ROBOT, ROBOT.fk(ROBOT.home), scene={}, objective="room")
    assert caught.value.allowed == ["motion", "clearance"]
    with pytest.raises(InvalidRequest) as caught:
        ikplan.plan(joint_path(3, objective="room"))
    assert caught.value.field == "ik.objective"
