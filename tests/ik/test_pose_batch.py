"""Many poses at a time: each as it is solved alone, whatever it is solved with."""

import time
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.errors import InvalidRequest, Unreachable
from ikplan.ik.poses.arrays import pose_arrays
from ikplan.ik.poses.batch import solve_batch
from ikplan.kinematics.arm import arm_of
from ikplan.pipeline.pose_batch.request import solve_ik_batch_request, solve_ik_requests
from ikplan.robots import Robot

ROBOTS = ("iiwa14", "ur5", "z1")


def reachable(robot: Robot, count: int, seed: int = 0) -> tuple[np.ndarray, list[pin.SE3]]:
    rng = np.random.default_rng(seed)
    q = np.array([robot.random_configuration(rng) for _ in range(count)])
    return q, [robot.fk(row) for row in q]


@pytest.mark.parametrize("name", ROBOTS)
def test_every_reachable_pose_is_reached_by_pinocchio(name: str) -> None:
    robot = ikplan.load_robot(name)
    _, poses = reachable(robot, 300)
    found = ikplan.solve_ik_batch(robot, poses)
    assert found.q.shape == (300, robot.dof)
    assert found.solved.dtype == bool
    assert found.solved.all()
    assert (found.q >= robot.lower).all()
    assert (found.q <= robot.upper).all()
    for q, pose in zip(found.q, poses, strict=True):
        assert np.linalg.norm(pin.log6(robot.fk(q).actInv(pose)).vector) < 1e-8


@pytest.mark.parametrize("name", ROBOTS)
def test_a_pose_is_solved_as_it_is_alone_in_any_batch_on_any_number_of_threads(name: str) -> None:
    robot = ikplan.load_robot(name)
    q, poses = reachable(robot, 200)
    starts = np.clip(q + 0.1, robot.lower, robot.upper)
    whole = ikplan.solve_ik_batch(robot, poses, start=starts, threads=1)
    parallel = ikplan.solve_ik_batch(robot, poses, start=starts, threads=3)
    assert np.array_equal(whole.q, parallel.q)
    assert np.array_equal(whole.position_error, parallel.position_error)
    for k in range(0, 200, 23):
        alone = ikplan.solve_ik(robot, poses[k], start=starts[k], method="lm")
        assert np.array_equal(alone.q, whole.q[k])
        one = ikplan.solve_ik_batch(robot, poses[k : k + 1], start=starts[k])
        assert np.array_equal(one.q[0], whole.q[k])
    assert np.array_equal(
        ikplan.solve_ik_batch(robot, poses[:3]).q[2],
        ikplan.solve_ik(robot, poses[2], method="lm").q,
    )


def test_poses_in_every_form_have_the_same_answer() -> None:
    robot = ikplan.load_robot("ur5")
    _, poses = reachable(robot, 20)
    matrices = np.array([pose.homogeneous for pose in poses])
    rows = np.array([pin.SE3ToXYZQUAT(pose) for pose in poses])
    expected = ikplan.solve_ik_batch(robot, poses)
    assert np.array_equal(ikplan.solve_ik_batch(robot, matrices).q, expected.q)
    # Rotations of quaternions are others by rounding, and so may be the branch that is found.
    assert ikplan.solve_ik_batch(robot, rows).solved.all()
    free = ikplan.solve_ik_batch(robot, matrices[:, :3, 3])
    assert free.solved.all()
    assert free.orientation_error is None
    assert ikplan.solve_ik_batch(robot, np.empty((0, 3))).q.shape == (0, 6)


@pytest.mark.parametrize("name", ["iiwa14", "ur5"])
def test_a_pose_out_of_reach_is_refused_with_a_reason_or_by_a_bare_no(name: str) -> None:
    robot = ikplan.load_robot(name)
    _, poses = reachable(robot, 3)
    poses[1] = pin.SE3(poses[1].rotation, np.array([3.0, 0.0, 0.5]))
    explained = ikplan.solve_ik_batch(robot, poses)
    bare = ikplan.solve_ik_batch(robot, poses, verdict=False)
    for found in (explained, bare):
        assert found.solved.tolist() == [True, False, True]
        assert found.position_error[1] > 0.5
        assert np.array_equal(found.q[[0, 2]], explained.q[[0, 2]])
    assert bare.refused == []
    (refused,) = explained.refused
    with pytest.raises(Unreachable) as alone:
        ikplan.solve_ik(robot, poses[1], method="lm")
    assert (refused.pose, refused.reason) == (1, alone.value.reason)
    assert np.array_equal(explained.q[1], alone.value.q)


def test_solutions_in_contact_are_replaced_or_refused() -> None:
    robot = ikplan.load_robot("ur5")
    start = robot.home
    pose = robot.fk(start)
    ball = {"name": "ball", "shape": {"type": "sphere", "radius": 0.03}}
    elbow = {**ball, "position": (robot.fk(start).translation * 0.0 + [0.0, 0.0, 9.0]).tolist()}
    on_tool = {**ball, "position": pose.translation.tolist()}
    clear = ikplan.solve_ik_batch(robot, [pose], scene={"obstacles": [elbow]})
    assert clear.solved.all()
    blocked = ikplan.solve_ik_batch(robot, [pose, pose], scene={"obstacles": [on_tool]})
    assert not blocked.solved.any()
    assert [r.pose for r in blocked.refused] == [0, 1]
    assert "ball" in blocked.refused[0].reason


@pytest.mark.parametrize("method", ["lm", "ik-ba", "newton-raphson"])
def test_a_pose_in_contact_has_finite_errors_and_a_count_whatever_the_method(method: str) -> None:
    robot = ikplan.load_robot("ur5")
    pose = robot.fk(robot.home)
    ball = {"name": "ball", "shape": {"type": "sphere", "radius": 0.03}}
    scene = {"obstacles": [{**ball, "position": pose.translation.tolist()}]}
    found = ikplan.solve_ik_batch(robot, [pose], scene=scene, method=method)
    assert not found.solved.any()
    T = robot.fk(found.q[0])
    error = pin.log6(T.actInv(pose))
    assert found.position_error[0] == pytest.approx(
        np.linalg.norm(T.translation - pose.translation)
    )
    assert found.orientation_error is not None
    assert found.orientation_error[0] == pytest.approx(np.linalg.norm(error.angular), abs=1e-6)
    assert found.evaluations >= 0


def test_another_method_solves_each_pose_as_alone() -> None:
    robot = ikplan.load_robot("ur5")
    _, poses = reachable(robot, 2)
    found = ikplan.solve_ik_batch(robot, poses, method="ik-ba", seed=3)
    for k, pose in enumerate(poses):
        alone = ikplan.solve_ik(robot, pose, method="ik-ba", seed=3)
        assert np.array_equal(found.q[k], alone.q)


@pytest.mark.parametrize(
    ("poses", "start", "field"),
    [
        ([[0.4, 0.0, 0.4], [0.4, np.nan, 0.4]], None, "poses[1]"),
        ([[0.4, 0.0, 0.4, 0.0, 0.0, 0.0, 2.0]], None, "poses[0]"),
        (np.zeros((2, 4, 4)), None, "poses[0]"),
        (np.diag([1.0, 1.0, -1.0, 1.0])[None], None, "poses[0]"),
        ([[0.4, 0.0]], None, "poses"),
        ("here", None, "poses"),
        ([[0.4, 0.0, 0.4]] * 2, [[0.0] * 6, [0.0] * 5 + [99.0]], "start[1][5]"),
        ([[0.4, 0.0, 0.4]] * 2, [[0.0] * 6] * 3, "start"),
        ([[0.4, 0.0, 0.4]] * 2, [[0.0] * 6, [0.0] * 5], "start"),
        ([[0.4, 0.0, 0.4]], [0.0] * 5, "start"),
    ],
)
def test_what_makes_no_sense_is_told_with_its_place(poses: Any, start: Any, field: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        ikplan.solve_ik_batch(ikplan.load_robot("ur5"), poses, start=start)
    assert caught.value.field == field


def test_a_request_of_many_poses_and_requests_of_one_have_the_same_answers() -> None:
    robot = ikplan.load_robot("ur5")
    _, placed = reachable(robot, 6)
    rows = [pin.SE3ToXYZQUAT(pose).tolist() for pose in placed]
    poses = [{"position": row[:3], "quaternion_xyzw": row[3:]} for row in rows]
    poses[2]["position"] = [5.0, 0.0, 0.0]
    many = solve_ik_batch_request({"robot": "ur5", "poses": poses})
    single = [{"robot": "ur5", **pose, "ik": {"method": "lm"}} for pose in poses]
    single[4] = {**single[4], "start": [9.0] * 6}
    single.insert(0, {"robot": "ur5", "positions": []})
    wrong, *answers = solve_ik_requests(single)
    assert isinstance(wrong, InvalidRequest)
    assert isinstance(answers[2], Unreachable)
    assert answers[2].reason == many.refused[0].reason
    assert isinstance(answers[4], InvalidRequest)
    assert answers[4].field == "start[0]"
    for k in (0, 1, 3, 5):
        answer = answers[k]
        assert isinstance(answer, ikplan.IkSolution)
        assert np.array_equal(answer.q, many.q[k])
        assert answer.elongation == pytest.approx(np.linalg.norm(many.q[k] - robot.home))
    bare = {**single[3], "verdict": False}
    (no,) = solve_ik_requests([bare])
    assert isinstance(no, Unreachable)
    assert "no verdict was asked for" in no.reason


def test_the_budget_of_a_batch_counts_what_its_threads_do() -> None:
    robot = ikplan.load_robot("ur5")
    _, poses = reachable(robot, 600)
    arm, asked = arm_of(robot), pose_arrays(poses)
    told: list[tuple[Any, ...]] = []

    def solve(threads: int) -> tuple[float, float]:
        told.clear()
        begin = time.process_time(), time.thread_time()
        solve_batch(
            arm, asked, robot.home[None], 1e-9, 1e-9, 50, 40, 0,
            threads=threads, check=lambda *part: told.append(part),
        )  # fmt: skip
        own = time.thread_time() - begin[1]
        assert sum(count for count, _ in told) == 600
        return time.process_time() - begin[0] - own, sum(share for _, share in told)

    assert solve(1)[1] == 0.0  # the thread of the plan counts itself
    others, share = solve(2)
    assert 0.5 * others < 2 * share <= others
