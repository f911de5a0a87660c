"""plan() on short, odd and degenerate paths, and the laws that frames and tools obey."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan import BudgetExceeded, Plan, Unreachable, load_robot
from tests.measured import check_motion, waypoint_errors
from tests.present import present

from .paths import helix, on, pose, printed_helix


def near_home(name: str, count: int, size: float = 0.3, seed: int = 81) -> list[pin.SE3]:
    """Poses that the robot reaches, each a joint step from the one before."""
    robot = load_robot(name)
    rng = np.random.default_rng(seed)
    q, poses = robot.home, []
    for _ in range(count):
        q = robot.clip(q + size * rng.uniform(-1, 1, robot.dof))
        poses.append(robot.fk(q))
    return poses


def check(plan: Plan, poses: list[pin.SE3], *, oriented: bool = True) -> None:
    """Every waypoint is met, seen by Pinocchio."""
    robot = load_robot(plan.robot)
    check_motion(plan.trajectory, robot)
    assert len(plan.waypoints.q) == len(poses)
    for q, want in zip(plan.waypoints.q, poses, strict=True):
        have = robot.fk(q)
        assert np.abs(have.translation - want.translation).max() <= 1e-6
        if oriented:
            assert np.abs(have.rotation - want.rotation).max() <= 1e-6


@pytest.mark.parametrize("elongation", ["global", "greedy"])
@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_full_poses_on_every_robot(name: str, elongation: str) -> None:
    poses = near_home(name, 5)
    # Near its home an arm may touch itself: that is tested elsewhere.
    scene = {"self_collision": False}
    plan = ikplan.plan(on(name, *map(pose, poses), ik={"elongation": elongation}, scene=scene))
    check(plan, poses)
    np.testing.assert_array_equal(plan.trajectory.q[0], load_robot(name).home)
    assert plan.joint_units == ["m" if s else "rad" for s in load_robot(name).prismatic]


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_positions_alone_on_every_robot(name: str) -> None:
    poses = near_home(name, 4, seed=82)
    waypoints = [{"position": T.translation.tolist()} for T in poses]
    plan = ikplan.plan(on(name, *waypoints, ik={"method": "lm"}))
    check(plan, poses, oriented=False)
    assert plan.waypoints.orientation_error == [None] * 4
    assert plan.certificate.max_orientation_error is None


def test_some_waypoints_with_and_some_without_orientation() -> None:
    poses = near_home("ur5", 4, seed=83)
    waypoints = [pose(T) for T in poses]
    del waypoints[1]["quaternion_xyzw"]
    plan = ikplan.plan(on("ur5", *waypoints))
    errors = plan.waypoints.orientation_error
    assert errors[1] is None
    assert all(present(e) <= 1e-6 for k, e in enumerate(errors) if k != 1)


@pytest.mark.parametrize("method", ["lm", "ik-ba"])
def test_a_free_start_begins_at_the_first_waypoint(method: str) -> None:
    poses = near_home("iiwa14", 4, seed=84)
    request = on("iiwa14", *map(pose, poses), ik={"method": method})
    free = ikplan.plan({**request, "start": "free"})
    check(free, poses)
    np.testing.assert_array_equal(free.trajectory.q[0], free.waypoints.q[0])
    assert free.waypoints.elongation[0] == 0.0
    assert free.waypoints.time[0] == 0.0
    assert free.certificate.elongation_sum < ikplan.plan(request).certificate.elongation_sum


def test_without_a_start_the_path_begins_at_home() -> None:
    poses = near_home("z1", 2)
    home = load_robot("z1").home
    default = ikplan.plan(on("z1", *map(pose, poses)))
    np.testing.assert_array_equal(default.trajectory.q[0], home)
    given = ikplan.plan(on("z1", *map(pose, poses), start=home))
    np.testing.assert_array_equal(given.trajectory.q, default.trajectory.q)


def test_a_start_that_is_the_only_waypoint_is_a_plan_without_motion() -> None:
    robot = load_robot("iiwa14")
    plan = ikplan.plan(on("iiwa14", pose(robot.fk(robot.home)), start=robot.home))
    assert plan.duration == 0.0
    assert plan.trajectory.time.tolist() == [0.0]
    assert not plan.trajectory.dq.any()
    np.testing.assert_array_equal(plan.trajectory.q, [robot.home])
    np.testing.assert_allclose(plan.waypoints.q, [robot.home], atol=1e-9)
    one = ikplan.plan(on("iiwa14", pose(robot.fk(robot.home)), start="free"))
    assert one.duration == 0.0


def test_a_waypoint_given_several_times_is_passed_once() -> None:
    a, b = near_home("ur5", 2, seed=85)
    once = ikplan.plan(on("ur5", pose(a), pose(b)))
    twice = ikplan.plan(on("ur5", pose(a), pose(a), pose(a), pose(b), pose(b)))
    check(twice, [a, a, a, b, b])
    assert twice.duration == pytest.approx(once.duration, rel=1e-3)
    times = twice.waypoints.time
    assert times[0] == pytest.approx(times[2])
    assert times[3] == pytest.approx(times[4])


@pytest.mark.parametrize("size", [1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("rate_hz", [1.0, 250.0, 10_000.0])
def test_motions_of_any_smallness_are_certified(size: float, rate_hz: float) -> None:
    robot = load_robot("iiwa14")
    T = robot.fk(robot.home)
    moved = pin.SE3(T.rotation, T.translation + np.array([size, 0.0, 0.0]))
    plan = ikplan.plan(on("iiwa14", pose(moved), sampling={"rate_hz": rate_hz}))
    check(plan, [moved])
    # At least a period, and the waypoint passed when the samples pass it: at the end.
    assert plan.duration == 0.0 or plan.duration >= 1.0 / rate_hz * (1 - 1e-12)
    assert plan.waypoints.time[-1] == pytest.approx(plan.duration, rel=1e-12)


def test_a_motion_much_shorter_than_a_sample_period_passes_its_waypoints_in_order() -> None:
    robot = load_robot("ur5")
    T = robot.fk(robot.home)
    poses = [pin.SE3(T.rotation, T.translation + np.array([0.0, 0.0, 1e-4 * k])) for k in (1, 2, 3)]
    plan = ikplan.plan(on("ur5", *map(pose, poses), sampling={"rate_hz": 1.0}))
    check(plan, poses)
    assert plan.duration == 1.0
    assert 0.2 < plan.waypoints.time[0] < plan.waypoints.time[1] < 1.0


@pytest.mark.parametrize("rate_hz", [1.0, 33.3, 250.0, 9999.0])
def test_samples_come_at_the_rate_and_end_exactly(rate_hz: float) -> None:
    plan = ikplan.plan(on("ur5", *map(pose, near_home("ur5", 2)), sampling={"rate_hz": rate_hz}))
    time = plan.trajectory.time
    assert np.array_equal(time, np.arange(len(time)) / rate_hz)
    assert plan.waypoints.time[-1] == time[-1]


def test_moving_the_frame_and_the_waypoints_with_it_changes_nothing() -> None:
    poses = near_home("iiwa14", 4, seed=86)
    pin.seed(5)
    frame = pin.SE3.Random()
    plain = ikplan.plan(on("iiwa14", *map(pose, poses)))
    request = on("iiwa14", *(pose(frame.actInv(T)) for T in poses))
    request["path"]["frame"] = pose(frame)
    moved = ikplan.plan(request)
    check(moved, poses)
    np.testing.assert_allclose(moved.waypoints.q, plain.waypoints.q, atol=1e-3)
    assert moved.certificate.elongation_sum == pytest.approx(
        plain.certificate.elongation_sum, rel=1e-6
    )


def test_a_tool_moves_the_flange_by_its_inverse() -> None:
    robot = load_robot("iiwa14")
    tool = pin.SE3(pin.exp3(np.array([0.1, -0.2, 0.3])), np.array([0.02, -0.03, 0.1]))
    flange = near_home("iiwa14", 3, seed=87)
    plain = ikplan.plan(on("iiwa14", *map(pose, flange)))
    with_tool = ikplan.plan(on("iiwa14", *(pose(T * tool) for T in flange), tool=pose(tool)))
    for q, T in zip(with_tool.waypoints.q, flange, strict=True):
        assert np.abs(robot.fk(q).homogeneous - T.homogeneous).max() < 2e-6
    assert with_tool.certificate.elongation_sum == pytest.approx(
        plain.certificate.elongation_sum, rel=1e-5
    )


def test_a_robots_own_tool_stands_unless_the_request_has_one() -> None:
    robot = load_robot("ur5")
    long = robot.with_tool([0.0, 0.0, 0.2])
    target = {"position": [0.3, 0.2, 0.3]}
    q = ikplan.plan(on("ur5", target), robot=long).waypoints.q[0]
    np.testing.assert_allclose(long.fk(q).translation, target["position"], atol=1e-6)
    short = {"position": [0.0, 0.0, 0.05]}
    q = ikplan.plan(on("ur5", target, tool=short), robot=long).waypoints.q[0]
    have = robot.with_tool(short["position"]).fk(q).translation
    np.testing.assert_allclose(have, target["position"], atol=1e-6)


def test_half_the_speed_takes_twice_and_a_quarter_of_the_acceleration_too() -> None:
    waypoints = [*map(pose, near_home("ur5", 3))]
    whole = ikplan.plan(on("ur5", *waypoints))
    limits = {"velocity_scale": 0.5, "acceleration_scale": 0.25}
    slow = ikplan.plan(on("ur5", *waypoints, limits=limits))
    # But for the whole number of periods.
    once, twice = (plan.duration / present(plan.timing).grid_factor for plan in (whole, slow))
    assert twice == pytest.approx(2.0 * once, rel=5e-3)
    assert slow.certificate.velocity_limit_ratio <= 1.0 + 1e-9


def stretched(metres: float) -> dict[str, Any]:
    """A pose of the iiwa so many metres beyond its stretched arm."""
    robot = load_robot("iiwa14")
    T = robot.fk([0.4, 0.9, 0.0, 0.0, 0.0, 0.0, 0.0])
    outward = T.translation - np.array([0.0, 0.0, 0.36])
    return pose(pin.SE3(T.rotation, T.translation + metres * outward / np.linalg.norm(outward)))


@pytest.mark.parametrize("elongation", ["global", "greedy"])
def test_a_waypoint_out_of_reach_by_less_than_the_tolerance_is_met_as_well_as_can_be(
    elongation: str,
) -> None:
    ik = {"elongation": elongation}
    request = on("iiwa14", stretched(-0.1), stretched(5e-5), ik=ik)
    plan = ikplan.plan(request)
    check_motion(plan.trajectory, load_robot("iiwa14"))
    (near, turned), (far, askew) = waypoint_errors(plan, request["path"])
    assert max(near, turned) <= 1e-8
    assert far == pytest.approx(5e-5, rel=0.02)
    assert askew <= 1e-3
    assert plan.certificate.max_position_error == pytest.approx(far, abs=1e-12)
    request["path"]["tolerance"] = {"position": 4e-5}
    with pytest.raises(Unreachable) as caught:
        ikplan.plan(request)
    assert caught.value.waypoint == 1
    assert caught.value.position_error == pytest.approx(5e-5, rel=0.02)


@pytest.mark.parametrize(("method", "elongation"), [("lm", "global"), ("ik-ba", "greedy")])
def test_the_printed_helix_has_three_points_out_of_reach(method: str, elongation: str) -> None:
    request = printed_helix()
    request["ik"] = {"method": method, "elongation": elongation}
    with pytest.raises(Unreachable) as caught:
        ikplan.plan(request)
    error = caught.value
    assert error.waypoint == 0
    assert "waypoint 0 of 20" in error.detail
    assert [row["waypoint"] for row in error.waypoints] == [0, 18, 19]
    for row, distance in zip(error.waypoints, (0.8506, 0.8258, 0.8447), strict=True):
        assert f"{distance:.4f} m from the shoulder" in row["reason"]
        assert "0.4104 to 0.8200" in row["reason"]
        assert row["position_error"] == pytest.approx(distance - 0.82, abs=1e-4)


def test_waypoints_within_tolerance_are_not_counted_as_unreachable() -> None:
    with pytest.raises(Unreachable) as caught:
        ikplan.plan(on("iiwa14", stretched(0.01), stretched(5e-5), stretched(0.02)))
    assert [row["waypoint"] for row in caught.value.waypoints] == [0, 2]


def test_an_unrefined_search_is_taken_as_it_is_when_the_tolerance_allows() -> None:
    waypoints = [{"position": [0.5, 0.1, 0.5]}, {"position": [0.45, 0.2, 0.5]}]
    ik = {"refine": False, "population": "paper", "iterations": "paper"}
    request = on("iiwa14", *waypoints, ik=ik)
    request["path"]["tolerance"] = {"position": 2e-3}
    plan = ikplan.plan(request)
    assert plan.stats.ik_evaluations == 2 * 10_050
    assert 1e-7 < present(plan.certificate.max_position_error) <= 2e-3
    request["path"]["tolerance"] = {"position": 1e-7}
    with pytest.raises(Unreachable, match="without refinement"):
        ikplan.plan(request)


def test_an_unrefined_wrist_outside_its_limits_is_refused_as_such() -> None:
    """The paper's decoupling ignores the wrist limits: 15 to 37 % of its solutions break them."""
    outcomes = []
    for seed in range(6):
        request = helix()
        request["ik"] = {"refine": False, "seed": seed, "params": {"decouple": True}}
        request["path"]["tolerance"] = {"position": 0.2, "orientation": 0.1}
        try:
            ikplan.plan(request)
        except Unreachable as error:
            outcomes.append(error)
    assert outcomes
    for outcome in outcomes:
        assert outcome.limits
        assert "outside the limits" in outcome.detail


@pytest.mark.parametrize("elongation", ["global", "greedy"])
def test_a_budget_that_runs_out_says_in_which_stage(elongation: str) -> None:
    request = {**helix(), "budget_s": 1e-6, "ik": {"elongation": elongation}}
    with pytest.raises(BudgetExceeded) as caught:
        ikplan.plan(request)
    assert caught.value.stage == "ik"
    assert caught.value.budget_s == 1e-6
    assert "1e-06 s" in caught.value.detail


def test_a_budget_that_is_enough_changes_nothing() -> None:
    request = on("ur5", *map(pose, near_home("ur5", 2)))
    few, many = (ikplan.plan({**copy.deepcopy(request), "budget_s": b}) for b in (30.0, 3000.0))
    assert few.id == many.id
    np.testing.assert_array_equal(few.trajectory.q, many.trajectory.q)
