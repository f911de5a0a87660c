"""The verdict on targets out of reach: by how much, and why."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from ikplan import Robot, Unreachable, load_robot, plan, solve_ik
from ikplan.ik.closest_approach import explain_unreachable
from ikplan.ik.solve import NoSolution, PoseSolver, surest_solver
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import Target, pose_target
from tests.planning.planar import tool, two_links

EQ_27 = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
"""Tool orientation of the published helix; spec E1."""


def helix_point(k: int) -> np.ndarray:
    """Point k of the helix as printed, k = 0..19."""
    a = 4.0 * math.pi * k / 19.0
    return np.array([0.60 + 0.20 * math.cos(a), 0.20 * math.sin(a), 0.10 + 0.50 * k / 19.0])


def verdict(robot: Robot, pose: Any, **options: Any) -> Unreachable:
    with pytest.raises(Unreachable) as caught:
        solve_ik(robot, pose, **options)
    error = caught.value
    have = robot.fk(error.q)
    position = pose.translation if isinstance(pose, pin.SE3) else np.asarray(pose)
    assert error.position_error == pytest.approx(
        np.linalg.norm(have.translation - position), rel=1e-9
    )
    if isinstance(pose, pin.SE3):
        turn = np.linalg.norm(pin.log3(have.rotation.T @ pose.rotation))
        assert error.orientation_error == pytest.approx(turn, abs=1e-9)
    else:
        assert error.orientation_error is None
    assert (np.asarray(error.q) >= robot.lower).all()
    assert (np.asarray(error.q) <= robot.upper).all()
    assert error.reason in error.detail
    return error


@pytest.mark.parametrize("method", ["lm", "ik-ba"])
def test_three_points_of_the_printed_helix_are_beyond_the_elbow(method: str) -> None:
    robot = load_robot("iiwa14")
    distances = {0: 0.8506, 18: 0.8258, 19: 0.8447}
    for k in range(20):
        pose = pin.SE3(EQ_27, helix_point(k))
        if k not in distances:
            assert solve_ik(robot, pose, method=method).position_error <= 1e-6
            continue
        error = verdict(robot, pose, method=method)
        assert f"{distances[k]:.4f} m from the shoulder" in error.reason
        assert "0.4104 to 0.8200 m" in error.reason
        # The orientation held, the tool stays off by just what the elbow lacks.
        missing = distances[k] - 0.82
        assert error.position_error == pytest.approx(missing, abs=1e-4)
        assert error.orientation_error is not None
        assert error.orientation_error < 1e-4
        told = re.search(r"([\d.]+) mm too far", error.reason)
        assert told is not None
        assert float(told[1]) == pytest.approx(1e3 * missing, abs=0.1)


def test_a_wrist_too_close_to_the_shoulder_is_told() -> None:
    robot = load_robot("iiwa14")
    down = np.diag([1.0, -1.0, -1.0])
    pose = pin.SE3(down, np.array([0.3, 0.0, 0.36 - 0.126]))  # wrist 0.3 m beside the shoulder
    error = verdict(robot, pose)
    assert "0.3000 m from the shoulder, 110.4 mm too close" in error.reason


def test_a_position_out_of_reach_is_missed_by_what_the_arm_lacks() -> None:
    robot = load_robot("iiwa14")
    error = verdict(robot, [0.0, 0.0, 2.0])
    assert error.position_error == pytest.approx(2.0 - 1.306, abs=1e-4)
    assert "694.0 mm" in error.reason
    error = verdict(robot, [1.5, 0.0, 0.36], method="lm")
    assert error.position_error == pytest.approx(1.5 - 0.946, abs=1e-4)


def test_the_limit_that_binds_is_named() -> None:
    """The tool of the Dobot, asked for too low, stops where the forearm does."""
    robot = load_robot("dobot_magician")
    q = np.array([0.3, 0.8, robot.upper[2], 0.1])
    pose = robot.fk(q)
    below = pose.translation + np.array([0.0, 0.0, -0.005])
    error = verdict(robot, below)
    assert robot.joint_names[2] in error.limits
    assert robot.joint_names[2] in error.detail
    assert 0.0 < error.position_error <= 0.005 + 1e-9


def test_an_orientation_the_arm_does_not_have_is_told_as_such() -> None:
    robot = load_robot("dobot_magician")
    pose = robot.fk([0.2, 0.6, 0.5, 0.0])
    tilted = pin.SE3(pose.rotation @ pin.exp3(np.array([0.5, 0.0, 0.0])), pose.translation)
    error = verdict(robot, tilted)
    assert "orientation cannot be reached" in error.reason


def test_a_pose_just_outside_is_refused_and_just_inside_is_solved() -> None:
    robot = load_robot("iiwa14")
    stretched = robot.fk([0.4, 0.9, 0.0, 0.0, 0.0, 0.0, 0.0])
    outward = stretched.translation - np.array([0.0, 0.0, 0.36])
    outward /= np.linalg.norm(outward)
    beyond = pin.SE3(stretched.rotation, stretched.translation + 2e-5 * outward)
    within = pin.SE3(stretched.rotation, stretched.translation - 2e-5 * outward)
    assert verdict(robot, beyond).position_error == pytest.approx(2e-5, rel=0.02)
    assert solve_ik(robot, within).position_error <= 1e-6
    assert solve_ik(robot, within, method="lm").position_error <= 1e-6
    # With a tolerance that covers what is missing, the closest configuration will do.
    near = solve_ik(robot, beyond, tolerance_position=1e-4, tolerance_orientation=1e-3)
    assert near.position_error <= 1e-4


def test_the_verdict_is_the_same_every_time() -> None:
    robot = load_robot("panda")
    first, again = (verdict(robot, [2.0, 0.1, 0.3], seed=3) for _ in range(2))
    assert first.data == again.data


@pytest.mark.parametrize(
    ("shoulder", "elbow", "target"),
    [
        ((-2.9, 0.4), (-2.9, 2.9), (0.3, 0.8)),
        ((-2.9, 2.9), (-1.0, 1.0), (0.2, 0.1)),
        ((0.3, 2.9), (0.2, 2.9), (0.7, -0.6)),
        ((-0.5, 0.5), (-0.5, 0.5), (-0.3, 0.4)),
        ((-2.9, 2.9), (-2.9, 2.9), (1.1, 0.2)),
    ],
)
def test_the_limits_named_are_those_that_bind(
    shoulder: tuple[float, float], elbow: tuple[float, float], target: tuple[float, float]
) -> None:
    """Closest of a dense grid; a named limit a little wider brings the tool closer."""

    def closest(a: tuple[float, float], b: tuple[float, float]) -> float:
        grid = np.stack(
            np.meshgrid(np.linspace(*a, 1201), np.linspace(*b, 1201), indexing="ij"), axis=-1
        )
        return float(np.linalg.norm(tool(grid) - [*target, 0.0], axis=-1).min())

    def miss(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, list[int], np.ndarray]:
        arm = arm_of(two_links(a, b))
        start = np.clip(np.zeros(2), arm.lower, arm.upper)
        found, _ = explain_unreachable(arm, pose_target(np.array([*target, 0.0])), start, start)
        assert found.position_error == pytest.approx(
            float(np.linalg.norm(tool(found.q) - [*target, 0.0])), abs=1e-12
        )
        assert f"{1e3 * found.position_error:.1f} mm" in found.reason
        return found.position_error, found.limits, found.q

    distance, limits, q = miss(shoulder, elbow)
    assert distance == pytest.approx(closest(shoulder, elbow), abs=2e-3)
    for joint, bounds in enumerate((shoulder, elbow)):
        at = [abs(q[joint] - bound) <= 1e-6 for bound in bounds]
        assert (joint in limits) == any(at)
        if joint in limits:
            wider = (bounds[0] - 0.05 * at[0], bounds[1] + 0.05 * at[1])
            both = (wider, elbow) if joint == 0 else (shoulder, wider)
            assert miss(*both)[0] < distance - 1e-3


@pytest.mark.parametrize(("name", "joint"), [("z1", 4), ("z1", 3)])
def test_an_error_is_shared_between_position_and_orientation(name: str, joint: int) -> None:
    """Past a limit of the wrist by less than the tolerance, an exact orientation costs more."""
    robot = load_robot(name)
    rng = np.random.default_rng(3)
    refused = 0
    for _ in range(12):
        q = robot.random_configuration(rng)
        past = q.copy()
        q[joint] = robot.upper[joint]
        past[joint] = robot.upper[joint] + 8e-4
        T = robot.fk(past)
        off = pin.log6(robot.fk(q).actInv(T)).vector
        if np.linalg.norm(off[:3]) > 1e-4:
            continue
        tolerance: dict[str, Any] = {"tolerance_position": 1e-4, "tolerance_orientation": 1e-3}
        found = solve_ik(robot, T, start=q, method="lm", **tolerance)
        assert found.position_error <= 1e-4
        assert found.orientation_error is not None
        assert found.orientation_error <= 1e-3
        quaternion = pin.Quaternion(T.rotation).normalized().coeffs().tolist()
        waypoint = {"position": T.translation.tolist(), "quaternion_xyzw": quaternion}
        request = {"robot": name, "path": {"waypoints": [waypoint]}}
        found_plan = plan({**request, "scene": {"self_collision": False}})
        assert found_plan.certificate.valid
        try:
            solve_ik(robot, T, start=q, method="lm")
        except Unreachable:
            refused += 1
    assert refused > 0


def missed_by(solver: PoseSolver, target: Target, start: np.ndarray) -> float:
    """How far off a target the tool stays [m]."""
    try:
        return float(solver.solve(target, start).position_error.max())
    except NoSolution as verdict:
        return verdict.closest.position_error


def test_a_verdict_in_closed_form_is_that_of_a_search() -> None:
    robot = load_robot("ur5")
    arm, rng = arm_of(robot), np.random.default_rng(11)
    searching = PoseSolver(arm, "lm", tolerance_position=1e-9, tolerance_orientation=1e-9)
    out_of_reach = 0
    for _ in range(40):
        pose = robot.fk(robot.random_configuration(rng))
        target = pose_target(pose.translation * rng.uniform(0.6, 1.6), pose.rotation)
        surest = surest_solver(searching, target)
        assert surest.method == "closed-form"
        told = [missed_by(solver, target, robot.home) for solver in (surest, searching)]
        out_of_reach += told[0] > 1e-9
        assert told[0] == pytest.approx(told[1], rel=1e-2, abs=1e-9)
    assert 5 < out_of_reach < 35
    position_alone = pose_target(np.array([0.3, 0.2, 0.4]))
    assert surest_solver(searching, position_alone) is searching


def test_the_closest_approach_is_as_near_as_a_longer_search_comes() -> None:
    """Few steps from every seed, and more from the best: beside all the steps from all seeds."""
    for name in ("ur5", "iiwa14", "xarm7"):
        robot = load_robot(name)
        arm, rng = arm_of(robot), np.random.default_rng(5)
        for _ in range(6):
            pose = robot.fk(robot.random_configuration(rng))
            far = pose.translation * rng.uniform(1.3, 2.0)
            target = pose_target(far, pose.rotation)
            quick, _ = explain_unreachable(arm, target, robot.home, robot.home)
            long, _ = explain_unreachable(arm, target, robot.home, robot.home, restarts=600)
            assert quick.position_error <= 1.03 * long.position_error + 1e-6
