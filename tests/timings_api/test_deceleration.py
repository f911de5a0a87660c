"""Limits of slowing down beside those of speeding up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import ikplan
from ikplan.certificate import Claim, certify
from ikplan.documents.limits import LimitOptions
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import CertificateViolated
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot
from tests.present import present


@pytest.fixture(scope="module")
def robot() -> Robot:
    return ikplan.load_robot("ur5").with_limits(velocity=[1.0] * 6, acceleration=[2.0] * 6)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("speeding_up", "slowing_down"), [(0.5, 1.0), (1.0, 0.5), (0.5, 0.5)])
def test_one_joint_takes_the_time_of_its_trapezoid(
    robot: Robot, way: float, speeding_up: float, slowing_down: float
) -> None:
    limits = {"acceleration": speeding_up, "deceleration": slowing_down}
    far = robot.home + way * np.array([2.9, 0, 0, 0, 0, 0])
    plan = ikplan.time_path(robot, [robot.home, far], limits=limits, rate_hz=1000)
    exact = 2.9 + 0.5 / speeding_up + 0.5 / slowing_down
    assert plan.duration == pytest.approx(exact, abs=2e-3)
    v, a = way * plan.dq[:, 0], way * plan.ddq[:, 0]
    assert a.max() == pytest.approx(speeding_up, rel=1e-3)
    assert a[v > 1e-6].min() == pytest.approx(-slowing_down, rel=1e-3)


def test_joints_that_move_both_ways_keep_both(robot: Robot) -> None:
    far = robot.home + np.array([2.9, -2.9, 0, 0, 0, 0])
    limits = {"acceleration": 0.5, "deceleration": 1.0}
    plan = ikplan.time_path(robot, [robot.home, far], limits=limits, rate_hz=1000)
    assert plan.duration == pytest.approx(4.4, abs=2e-3)


def test_joints_that_turn_back_on_the_way_keep_both(robot: Robot) -> None:
    x = np.linspace(0.0, 2.0 * np.pi, 25)[:, None]
    rows = robot.home + np.sin(x) * np.array([0.5, 0.3, 0.0, 0.0, 0.0, 0.0])
    rows += x * np.array([0.0, 0.0, 0.2, 0.0, 0.1, 0.0])
    limits = {"acceleration": 0.5, "deceleration": 1.0}
    plan = ikplan.time_path(robot, rows, limits=limits)
    slows = plan.dq * plan.ddq < 0.0
    moves = np.abs(plan.dq) > 1e-6
    assert np.abs(plan.ddq[~slows & moves]).max() <= 0.5 * (1.0 + 1e-9)
    assert 0.9 < np.abs(plan.ddq[slows & moves]).max() <= 1.0 + 1e-9
    weak = ikplan.time_path(robot, rows, limits={"acceleration": 0.5})
    strong = ikplan.time_path(robot, rows, limits={"acceleration": 1.0})
    assert strong.duration < plan.duration < weak.duration
    assert plan.certificate.acceleration_limit_ratio <= 1.0 + 1e-9


def test_the_robots_own_limit_holds_for_slowing_down(robot: Robot) -> None:
    far = robot.home + np.array([1.0, 0, 0, 0, 0, 0])
    asked = ikplan.time_path(robot, [robot.home, far], limits={"deceleration": 50.0})
    own = ikplan.time_path(robot, [robot.home, far])
    assert asked.duration == own.duration


def test_the_certificate_refuses_a_joint_that_slows_down_too_fast(robot: Robot) -> None:
    far = robot.home + np.array([1.0, 0, 0, 0, 0, 0])
    plan = ikplan.time_path(robot, [robot.home, far], limits={"acceleration": 1.0})
    asked = MotionLimits.of(robot, LimitOptions(acceleration=1.0, deceleration=1.0))
    claim = Claim(
        robot=robot,
        path=None,
        q_start=robot.home,
        waypoint_q=plan.waypoints.q,
        waypoint_time=plan.waypoints.time,
        time=plan.time,
        q=plan.q,
        dq=plan.dq,
        ddq=plan.ddq,
        limits=asked,
    )
    assert certify(claim).valid
    stricter = MotionLimits.of(robot, LimitOptions(acceleration=1.0, deceleration=0.9))
    with pytest.raises(CertificateViolated, match="acceleration limit"):
        certify(replace(claim, limits=stricter))


def test_a_segment_has_a_deceleration_of_its_own(robot: Robot) -> None:
    """Speeding up on the first half, slowing down on the second, each with its own limits."""
    turn = np.array([1.0, 0, 0, 0, 0, 0])
    rows = [robot.home, robot.home + 1.45 * turn, robot.home + 2.9 * turn]
    segments = [{"first": 1, "last": 2, "limits": {"acceleration": 2.0, "deceleration": 0.5}}]
    plan = ikplan.time_path(robot, rows, segments=segments, rate_hz=1000)
    assert plan.duration == pytest.approx(2.9 + 0.5 / 2.0 + 0.5 / 0.5, abs=2e-3)
    slows = plan.dq[:, 0] * plan.ddq[:, 0] < -1e-9
    late = plan.time > plan.waypoints.time[1]
    assert np.abs(plan.ddq[slows & late, 0]).max() == pytest.approx(0.5, rel=1e-3)
    (part,) = plan.certificate.segments
    assert 0.99 < present(part.acceleration_limit_ratio) <= 1.0 + 1e-9


def test_a_segment_slows_down_as_the_whole_where_that_is_stricter(robot: Robot) -> None:
    far = robot.home + np.array([2.9, 0, 0, 0, 0, 0])
    own = [{"first": 0, "last": 1, "limits": {"deceleration": 1.5}}]
    whole = {"acceleration": 1.0, "deceleration": 0.5}
    both = ikplan.time_path(robot, [robot.home, far], limits=whole, segments=own, rate_hz=1000)
    one = ikplan.time_path(robot, [robot.home, far], limits=whole, rate_hz=1000)
    assert both.duration == pytest.approx(one.duration, abs=2e-3)
    weaker = [{"first": 0, "last": 1, "limits": {"deceleration": 0.25}}]
    slow = ikplan.time_path(robot, [robot.home, far], limits=whole, segments=weaker, rate_hz=1000)
    assert slow.duration == pytest.approx(2.9 + 0.5 / 1.0 + 0.5 / 0.25, abs=2e-3)


def test_segments_of_a_path_slow_down_by_their_own_limit_and_the_certificate_holds_them(
    robot: Robot,
) -> None:
    q = robot.home + np.array([0.8, 0.3, -0.4, 0, 0, 0])
    limits = {"deceleration": 0.3, "jerk": None}
    segment = {"type": "joint", "q": q.tolist(), "limits": limits}
    asked = {"robot": "ur5", "path": {"segments": [segment]}, "scene": {"self_collision": False}}
    plan = ikplan.plan(asked, robot=robot)
    slows = plan.dq * plan.ddq < -1e-9
    assert 0.29 < np.abs(plan.ddq[slows]).max() <= 0.3 * (1.0 + 1e-9)
    assert np.abs(plan.ddq[~slows]).max() > 0.5


def test_requests_without_a_deceleration_of_a_segment_keep_their_ids() -> None:
    def identity(**limits: float) -> str:
        line = {"type": "line", "to": {"position": [0.4, 0.1, 0.4]}, "limits": limits}
        document = {"robot": "ur5", "path": {"segments": [line]}}
        return PlanRequest.model_validate(document).content_hash()

    assert identity(velocity_scale=0.5) == "302f7a84d655c0cce4b18063eac63734"
    assert identity(velocity_scale=0.5, deceleration=1.0) != identity(velocity_scale=0.5)
