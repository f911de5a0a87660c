"""The figures of the demo: a helix of 20 full poses on the iiwa."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

from ikplan import load_robot
from tests.measured import check_motion
from tests.present import present

from .paths import HELIX, helix_plan

CASES = [
    *[(seed, "ik-ba", "global") for seed in range(5)],
    *[(seed, "ik-ba", "greedy") for seed in range(3)],
    (0, "lm", "global"),
]


@pytest.mark.parametrize(("seed", "method", "elongation"), CASES)
def test_each_waypoint_is_met_and_the_joints_move_little(
    seed: int, method: str, elongation: str
) -> None:
    plan = helix_plan(seed, method, elongation)
    robot = load_robot("iiwa14")
    for q, waypoint, e_p, e_r in zip(
        plan.waypoints.q,
        HELIX["path"]["waypoints"],
        plan.waypoints.position_error,
        plan.waypoints.orientation_error,
        strict=True,
    ):
        want = pin.XYZQUATToSE3(np.array([*waypoint["position"], *waypoint["quaternion_xyzw"]]))
        have = robot.fk(q)
        distance = np.linalg.norm(have.translation - want.translation)
        turn = np.linalg.norm(pin.log3(have.rotation.T @ want.rotation))
        assert distance <= 1e-6
        assert turn <= 1e-6
        assert e_p == pytest.approx(distance, abs=1e-12)
        assert e_r == pytest.approx(turn, abs=1e-12)
        assert ((robot.lower <= q) & (q <= robot.upper)).all()
    check_motion(plan.trajectory, robot, ends=(HELIX["start"], plan.waypoints.q[-1]))
    assert present(plan.certificate.max_position_error) <= 1e-6
    assert present(plan.certificate.max_orientation_error) <= 1e-6
    steps = np.diff(np.vstack([HELIX["start"], plan.waypoints.q]), axis=0)
    elongations = np.linalg.norm(steps, axis=1)
    np.testing.assert_allclose(plan.waypoints.elongation, elongations)
    assert plan.certificate.elongation_sum == pytest.approx(elongations.sum())
    # Best known: 551.6 deg.
    assert math.degrees(elongations.sum()) <= 565.0
    assert math.degrees(elongations.sum()) >= 551.0


def test_the_whole_path_is_chosen_better_than_waypoint_by_waypoint() -> None:
    whole = helix_plan().certificate.elongation_sum
    greedy = helix_plan(elongation="greedy").certificate.elongation_sum
    assert whole < greedy


def test_the_trajectory_keeps_its_contract() -> None:
    plan = helix_plan()
    robot = load_robot("iiwa14")
    t = plan.trajectory
    assert t.time[0] == 0.0
    steps = np.diff(t.time)
    np.testing.assert_allclose(steps[:-1], 1.0 / 250.0, rtol=1e-9)
    assert 0.5 / 250.0 <= steps[-1] <= 1.5 / 250.0
    np.testing.assert_array_equal(t.q[0], HELIX["start"])
    np.testing.assert_array_equal(t.q[-1], plan.waypoints.q[-1])
    assert not t.dq[0].any()
    assert not t.dq[-1].any()
    assert plan.duration == t.time[-1]
    assert (np.abs(t.dq) <= robot.velocity_limit * (1 + 1e-9)).all()
    assert (np.abs(t.ddq) <= robot.acceleration_limit * (1 + 1e-9)).all()
    # A limit is always in use: the motion is as fast as it may be.
    use = np.maximum(
        np.abs(t.dq / robot.velocity_limit).max(axis=1),
        np.abs(t.ddq / robot.acceleration_limit).max(axis=1),
    )
    assert np.median(use) > 0.99
    # Velocities are the derivative of the positions.
    slope = (t.q[2:-1] - t.q[:-3]) / (t.time[2:-1] - t.time[:-3])[:, None]
    np.testing.assert_allclose(slope, t.dq[1:-2], atol=0.01 * robot.acceleration_limit.max())


def test_the_tool_is_at_each_waypoint_at_its_time() -> None:
    plan = helix_plan()
    robot = load_robot("iiwa14")
    times = plan.waypoints.time
    assert (np.diff(times) > 0).all()
    assert times[-1] == pytest.approx(plan.duration, rel=1e-12)
    t = plan.trajectory
    for when, waypoint in zip(times, HELIX["path"]["waypoints"], strict=True):
        k = min(int(np.searchsorted(t.time, when, side="right")) - 1, len(t.time) - 2)
        since = when - t.time[k]
        q = t.q[k] + t.dq[k] * since + 0.5 * t.ddq[k] * since**2
        assert np.linalg.norm(robot.fk(q).translation - waypoint["position"]) < 5e-5
