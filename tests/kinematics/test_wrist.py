"""The spherical-wrist decoupling, and the shoulder-wrist distance."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.kinematics import forward
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.wrist import nearest_wrist, wrist_angles
from ikplan.robots import Robot, load_robot

from .synthetic import Joint, robot_of

SPHERICAL = {"iiwa14": 4e-13, "mh5": 4e-13, "kinova_j2s6s200": 2e-12, "tiago": 2e-11}
"""Arms with a spherical wrist, and the pose error allowed: the files of the last two give their
axes to so many digits only."""


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_a_wrist_is_found_where_the_last_three_axes_meet_at_right_angles(name: str) -> None:
    assert (arm_of(load_robot(name)).wrist is not None) == (name in SPHERICAL)


def both_branches(robot: Robot, q: np.ndarray, near: np.ndarray) -> np.ndarray:
    wrist = arm_of(robot).wrist
    assert wrist is not None
    R_arm, _ = forward(wrist.arm, q[:-3])
    out = np.empty((2, 3))
    wrist_angles(wrist, R_arm, robot.fk(q).rotation.copy(), near, out)
    return out


def chosen(robot: Robot, q: np.ndarray, near: np.ndarray) -> tuple[bool, np.ndarray]:
    wrist = arm_of(robot).wrist
    assert wrist is not None
    R_arm, _ = forward(wrist.arm, q[:-3])
    out = np.empty(3)
    return nearest_wrist(wrist, R_arm, robot.fk(q).rotation.copy(), near, out), out


@pytest.mark.parametrize("tool", [False, True], ids=["flange", "tool"])
@pytest.mark.parametrize("name", SPHERICAL)
def test_both_branches_meet_the_pose(name: str, tool: bool) -> None:
    robot = load_robot(name)
    if tool:
        robot = robot.with_tool([0.1, -0.2, 0.3], [0.5, 0.5, -0.5, 0.5])
    wrist = arm_of(robot).wrist
    assert wrist is not None
    rng = np.random.default_rng(21)
    for _ in range(1000):
        q = robot.random_configuration(rng)
        pose = robot.fk(q)
        _, centre = forward(wrist.arm, q[:-3])
        wanted = pose.translation + pose.rotation @ wrist.tool_to_centre
        assert np.abs(centre - wanted).max() < SPHERICAL[name]
        near = robot.random_configuration(rng)[-3:]
        for angles in both_branches(robot, q, near):
            got = robot.fk(np.concatenate([q[:-3], angles]))
            assert np.abs(got.homogeneous - pose.homogeneous).max() < SPHERICAL[name]


@pytest.mark.parametrize("name", SPHERICAL)
def test_the_branch_nearest_to_a_configuration_is_that_configuration(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(22)
    for _ in range(300):
        q = robot.random_configuration(rng)
        inside, angles = chosen(robot, q, q[-3:].copy())
        assert inside
        np.testing.assert_allclose(angles, q[-3:], atol=1e-9)


@pytest.mark.parametrize("bend", [1.1e-9, 1e-8, 1e-6, 1e-3])
def test_near_the_singular_wrist_the_pose_is_still_exact(bend: float) -> None:
    rng = np.random.default_rng(23)
    for name in ("iiwa14", "mh5"):
        robot = load_robot(name)
        for _ in range(50):
            q = robot.random_configuration(rng)
            q[-2] = bend
            for angles in both_branches(robot, q, robot.random_configuration(rng)[-3:]):
                got = robot.fk(np.concatenate([q[:-3], angles]))
                assert np.abs(got.homogeneous - robot.fk(q).homogeneous).max() < 4e-13


def test_at_the_singular_wrist_the_fifth_joint_rests_and_the_seventh_turns() -> None:
    robot = load_robot("iiwa14")
    rng = np.random.default_rng(24)
    for _ in range(200):
        q = robot.random_configuration(rng)
        q[-2] = 0.0
        near = robot.random_configuration(rng)[-3:]
        for angles in both_branches(robot, q, near):
            assert angles[0] == near[0]
            got = robot.fk(np.concatenate([q[:-3], angles]))
            assert np.abs(got.homogeneous - robot.fk(q).homogeneous).max() < 4e-13


def test_of_two_branches_inside_the_limits_the_nearer_is_chosen() -> None:
    robot = load_robot("iiwa14")
    lower, upper = robot.lower[-3:], robot.upper[-3:]
    rng = np.random.default_rng(25)
    seen = set()
    for _ in range(500):
        q = robot.random_configuration(rng)
        near = robot.random_configuration(rng)[-3:]
        branches = both_branches(robot, q, near)
        within = [bool(((lower <= b) & (b <= upper)).all()) for b in branches]
        inside, angles = chosen(robot, q, near)
        candidates = [b for b, ok in zip(branches, within, strict=True) if ok or not any(within)]
        nearest = min(candidates, key=lambda b: np.linalg.norm(b - near))
        np.testing.assert_array_equal(angles, nearest)
        assert inside == any(within)
        seen.add(sum(within))
    assert seen >= {1, 2}


def test_without_a_branch_inside_the_limits_the_nearer_is_given_and_said_to_be_outside() -> None:
    """A wrist that bends between 0.2 and 1 rad only, asked to be bent by 1.5."""
    robot = robot_of(
        [
            Joint("revolute", xyz=(0, 0, 0.3)),
            Joint("revolute", axis=(0, 1, 0)),
            Joint("revolute", xyz=(0, 0, 0.4), lower=-1, upper=1),
            Joint("revolute", axis=(0, 1, 0), lower=0.2, upper=1.0),
            Joint("revolute", lower=-1, upper=1),
        ],
        tip=Joint("fixed", xyz=(0, 0, 0.1)),
    )
    near = np.array([0.0, 0.5, 0.0])
    assert chosen(robot, np.array([0.3, 0.4, 0.1, 0.9, -0.2]), near)[0]
    inside, angles = chosen(robot, np.array([0.3, 0.4, 0.1, 1.5, -0.2]), near)
    assert not inside
    np.testing.assert_allclose(angles, [0.1, 1.5, -0.2], atol=1e-12)


@pytest.mark.parametrize("turns", [-1000, -3, -1, 0, 2, 1000])
@pytest.mark.parametrize("name", SPHERICAL)
def test_of_the_copies_of_an_angle_inside_the_limits_the_nearest_is_given(
    name: str, turns: int
) -> None:
    robot = load_robot(name)
    lower, upper = robot.lower[-3:], robot.upper[-3:]
    rng = np.random.default_rng(26)
    for _ in range(50):
        q = robot.random_configuration(rng)
        near = robot.random_configuration(rng)[-3:] + 2.0 * math.pi * turns
        for branch in both_branches(robot, q, near):
            for k, value in enumerate(branch):
                copies = value + 2.0 * math.pi * np.arange(-2100, 2101)
                inside = copies[(copies >= lower[k]) & (copies <= upper[k])]
                if len(inside):
                    assert abs(value - near[k]) <= np.abs(inside - near[k]).min() + 1e-9
                    assert lower[k] <= value <= upper[k]
                else:
                    assert -math.pi < value <= math.pi


def test_the_reach_of_the_iiwa_is_that_of_its_elbow() -> None:
    shoulder = arm_of(load_robot("iiwa14")).shoulder
    assert shoulder is not None
    np.testing.assert_allclose(shoulder.centre, [0, 0, 0.36], atol=1e-12)
    nearest = math.sqrt(0.42**2 + 0.40**2 + 2 * 0.42 * 0.40 * math.cos(math.radians(120)))
    assert shoulder.nearest == pytest.approx(nearest, abs=1e-12)
    assert shoulder.farthest == pytest.approx(0.82, abs=1e-12)


@pytest.mark.parametrize(
    ("lower", "upper"),
    [(-2.0, 2.0), (0.5, 2.0), (0.3, 5.9), (2.0, 5.9), (-5.0, -2.0), (-6.2, 6.2), (3.0, 3.1)],
)
def test_the_reach_covers_the_whole_range_of_the_elbow(lower: float, upper: float) -> None:
    robot = robot_of(
        [
            Joint("revolute", xyz=(0, 0, 0.3)),
            Joint("revolute", axis=(0, 1, 0)),
            Joint("revolute", axis=(0, 1, 0), xyz=(0.05, 0, 0.4), lower=lower, upper=upper),
            Joint("revolute", xyz=(0.03, 0, 0.5)),
            Joint("revolute", axis=(0, 1, 0)),
            Joint("revolute"),
        ],
        tip=Joint("fixed", xyz=(0, 0, 0.1)),
    )
    arm = arm_of(robot)
    assert arm.shoulder is not None
    assert arm.wrist is not None
    distances = []
    for elbow in np.linspace(lower, upper, 20_001):
        _, W = forward(arm.wrist.arm, np.array([0.3, -0.2, elbow]))
        distances.append(np.linalg.norm(W - arm.shoulder.centre))
    assert arm.shoulder.nearest == pytest.approx(min(distances), abs=1e-6)
    assert arm.shoulder.farthest == pytest.approx(max(distances), abs=1e-6)
    assert arm.shoulder.nearest <= min(distances) + 1e-12
    assert arm.shoulder.farthest >= max(distances) - 1e-12


def test_an_arm_whose_first_axes_do_not_meet_has_no_shoulder() -> None:
    assert arm_of(load_robot("mh5")).shoulder is None
    assert arm_of(load_robot("tiago")).shoulder is None
    assert arm_of(load_robot("ur5")).shoulder is None


def test_search_bounds_of_joints_without_end_are_half_a_turn_around_the_start() -> None:
    robot = load_robot("kinova_j2s6s200")
    q_start = np.where(robot.continuous, 7.0, robot.home)
    lower, upper = arm_of(robot).search_bounds(q_start)
    np.testing.assert_allclose(lower[robot.continuous], 7.0 - math.pi)
    np.testing.assert_allclose(upper[robot.continuous], 7.0 + math.pi)
    np.testing.assert_array_equal(lower[~robot.continuous], robot.lower[~robot.continuous])
    np.testing.assert_array_equal(upper[~robot.continuous], robot.upper[~robot.continuous])
