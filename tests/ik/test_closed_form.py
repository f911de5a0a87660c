"""The method closed-form: every branch, the nearest of them first, and what it does elsewhere."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.errors import InvalidRequest, Unreachable
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.closed_form.form import WITHOUT_FORM
from ikplan.kinematics.target import pose_target
from ikplan.planning.ladder.ik_candidates import IkCandidates, sample_ik_solutions
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.robots import Robot, load_robot

ARMS = ["ur5", "tm5_900", "abb_irb2400_12_155", "kuka_kr6_r900_2", "kinova_j2s6s200"]


def off(robot: Robot, q: Any, pose: pin.SE3) -> float:
    """How far the tool is from a pose by Pinocchio [m and rad]."""
    return float(np.abs(pin.log6(robot.fk(q).actInv(pose)).vector).max())


@pytest.mark.parametrize("name", ARMS)
def test_the_solution_is_exact_inside_the_limits_and_no_farther_than_any_other_found(
    name: str,
) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(4)
    for _ in range(25):
        pose, start = robot.fk(robot.random_configuration(rng)), robot.random_configuration(rng)
        found = ikplan.solve_ik(robot, pose, start=start, method="closed-form")
        assert off(robot, found.q, pose) < 1e-9
        assert ((robot.lower <= found.q) & (found.q <= robot.upper)).all()
        assert found.elongation == pytest.approx(np.linalg.norm(found.q - start), abs=1e-12)
        for method in ("lm", "ik-ba"):
            other = ikplan.solve_ik(robot, pose, start=start, method=method)
            assert found.elongation <= other.elongation + 1e-6, method


def test_all_branches_of_a_pose_come_nearest_first() -> None:
    robot = load_robot("ur5")
    start = np.array([0.3, -1.0, 1.2, 0.4, 0.8, 0.7])
    pose = robot.fk(start)
    solver = PoseSolver(arm_of(robot), "closed-form")
    solved = solver.solve(pose_target(pose.translation, pose.rotation), start)
    assert len(solved.q) == 8
    np.testing.assert_allclose(solved.q[0], start, rtol=0, atol=1e-9)
    away = np.linalg.norm(solved.q - start, axis=1)
    assert (np.diff(away) >= 0.0).all()
    assert max(off(robot, q, pose) for q in solved.q) < 1e-9
    first = ikplan.solve_ik(robot, pose, start=start, method="closed-form")
    np.testing.assert_allclose(first.q, solved.q[0], rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "q"),
    [
        ("ur5", [0.3, -1.0, 1.2, 0.4, 0.0, 0.7]),
        ("ur5", [0.3, -1.0, 0.0, 0.4, 0.9, 0.7]),
        ("abb_irb2400_12_155", [0.3, 0.2, 0.1, 0.5, 0.0, 0.7]),
    ],
)
def test_singular_poses_are_solved_all_the_same(name: str, q: list[float]) -> None:
    robot = load_robot(name)
    pose = robot.fk(q)
    found = ikplan.solve_ik(robot, pose, start=q, method="closed-form")
    assert off(robot, found.q, pose) < 1e-6
    assert found.elongation < 1e-3
    far = ikplan.solve_ik(robot, pose, method="closed-form")
    assert off(robot, far.q, pose) < 1e-6


def test_positions_and_joints_without_end_are_solved() -> None:
    robot = load_robot("kinova_j2s6s200")
    rng = np.random.default_rng(8)
    for _ in range(10):
        q = robot.random_configuration(rng)
        start = robot.random_configuration(rng)
        pose = robot.fk(q)
        endless = ~np.isfinite(robot.upper)
        found = ikplan.solve_ik(robot, pose, start=start, method="closed-form")
        assert endless.any()
        assert (np.abs(found.q - start)[endless] <= math.pi + 1e-9).all()
        point = ikplan.solve_ik(robot, pose.translation, start=start, method="closed-form")
        assert np.linalg.norm(robot.fk(point.q).translation - pose.translation) < 1e-6


def test_a_pose_out_of_reach_is_refused_with_the_verdict_of_the_other_methods() -> None:
    robot = load_robot("ur5")
    pose = pin.SE3(np.eye(3), np.array([1.5, 0.0, 0.3]))
    with pytest.raises(Unreachable) as refused:
        ikplan.solve_ik(robot, pose, method="closed-form")
    with pytest.raises(Unreachable) as by_lm:
        ikplan.solve_ik(robot, pose, method="lm")
    assert refused.value.position_error == pytest.approx(by_lm.value.position_error, rel=1e-3)


def test_a_branch_beyond_the_limits_is_no_solution() -> None:
    robot = load_robot("ur5", limits={"elbow_joint": {"lower": 0.0}})
    rng = np.random.default_rng(2)
    for _ in range(20):
        pose = robot.fk(robot.random_configuration(rng))
        assert ikplan.solve_ik(robot, pose, method="closed-form").q[2] >= 0.0


def test_an_arm_without_a_closed_form_is_told_so_with_the_other_methods() -> None:
    robot = load_robot("iiwa14")
    with pytest.raises(InvalidRequest, match="no closed form") as refused:
        ikplan.solve_ik(robot, robot.fk(robot.home), method="closed-form")
    assert refused.value.field == "ik.method"
    assert "lm" in refused.value.allowed
    assert "closed-form" not in refused.value.allowed


def candidates(robot: Robot, poses: list[pin.SE3], *, closed: bool) -> IkCandidates:
    arm = arm_of(robot)
    return sample_ik_solutions(
        arm.chain,
        stack_targets([pose_target(pose.translation, pose.rotation) for pose in poses]),
        np.empty((len(poses), 0, arm.dof)),
        np.array(robot.home),
        arm.lower,
        arm.upper,
        40,
        300,
        60,
        0.5,
        1e-9,
        arm.closed_form if closed else WITHOUT_FORM,
    )


@pytest.mark.parametrize("name", ["ur5", "kuka_kr6_r900_2"])
def test_the_planners_candidates_are_those_that_dense_sampling_finds(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(12)
    q, poses = np.array(robot.home), []
    for _ in range(6):
        q = robot.clip(q + 0.4 * rng.uniform(-1, 1, robot.dof))
        poses.append(robot.fk(q))
    closed, sampled = (candidates(robot, poses, closed=form) for form in (True, False))
    for k, pose in enumerate(poses):
        rows, dense = closed.q[k, : closed.counts[k]], sampled.q[k, : sampled.counts[k]]
        assert max(off(robot, row, pose) for row in rows) < 1e-9
        for row in dense:
            assert np.abs(rows - row).max(axis=1).min() < 1e-6
    assert 20 * closed.evaluations[0] < sampled.evaluations[0]


def test_a_singular_waypoint_is_sampled_as_on_any_arm() -> None:
    """Closed forms alone take less than a 20th; with them the candidates are complete earlier."""
    robot = load_robot("ur5")
    poses = [robot.fk([0.3, -1.0, 1.2, 0.4, 0.0, 0.7])]
    closed, sampled = (candidates(robot, poses, closed=form) for form in (True, False))
    assert closed.counts[0] >= sampled.counts[0] > 8
    assert 2 * closed.evaluations[0] > sampled.evaluations[0]


def test_a_plan_may_name_the_method() -> None:
    robot = load_robot("ur5")
    rng = np.random.default_rng(6)
    poses = [
        robot.fk(robot.clip(robot.home + 0.3 * rng.uniform(-1, 1, robot.dof))) for _ in range(4)
    ]
    waypoints = [
        {
            "position": pose.translation.tolist(),
            "quaternion_xyzw": pin.Quaternion(pose.rotation).coeffs().tolist(),
        }
        for pose in poses
    ]
    request = {"robot": "ur5", "path": {"waypoints": waypoints}, "ik": {"method": "closed-form"}}
    plan = ikplan.plan(request)
    searched = ikplan.plan({**request, "ik": {"method": "ik-ba"}})
    assert plan.certificate.max_position_error == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(plan.waypoints.q, searched.waypoints.q, rtol=0, atol=1e-6)
