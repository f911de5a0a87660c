"""Limits of a request are kept by the motion, and the certificate's figures are Pinocchio's."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import CertificateViolated, Plan, TimingFailed
from ikplan.certificate import Claim, certify
from ikplan.documents.limits import LimitOptions
from ikplan.limits.motion_limits import MotionLimits
from ikplan.plans.figures.phase_plane import path_speed, path_speed_bound
from tests.measured import check_motion, limit_ratios
from tests.present import present


def path(name: str, size: float = 0.4, n: int = 6) -> np.ndarray:
    robot = ikplan.load_robot(name)
    rng = np.random.default_rng(5)
    return robot.clip(robot.home) + np.vstack(
        [np.zeros(robot.dof), size * (rng.random((n - 1, robot.dof)) - 0.5)]
    )


def timed(name: str, limits: dict[str, Any], **options: Any) -> Plan:
    return ikplan.time_path(ikplan.load_robot(name), path(name), limits=limits, **options)


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_torques_with_a_payload_stay_within_their_limits(name: str) -> None:
    robot = ikplan.load_robot(name).with_tool([0.0, 0.0, 0.1])
    q = path(name)
    mass, centre = 1.5, np.array([0.02, 0.0, 0.05])
    free = ikplan.time_path(robot, q)
    payload = {"mass": mass, "position": centre}

    model, data = robot.model.copy(), None
    tip = model.frames[robot.tip_frame_id]
    model.appendBodyToJoint(
        tip.parentJoint,
        pin.Inertia(mass, centre, np.zeros((3, 3))),
        tip.placement * robot.T_tip_tool,
    )
    data = model.createData()

    def torques(plan: Plan) -> np.ndarray:
        return np.array(
            [pin.rnea(model, data, *row) for row in zip(plan.q, plan.dq, plan.ddq, strict=True)]
        )

    # As far above what it takes to stand there as half of what the free motion takes.
    still = np.array([pin.computeGeneralizedGravity(model, data, row) for row in free.q])
    most = np.abs(torques(free)).max(axis=0)
    limit = np.abs(still).max(axis=0) + 0.5 * np.maximum(most - np.abs(still).max(axis=0), 0.5)
    kept = ikplan.time_path(robot, q, limits={"torque": limit, "payload": payload})
    ratios = np.abs(torques(kept)) / np.minimum(limit, robot.effort_limit)
    assert ratios.max() <= 1.0
    assert kept.certificate.torque_limit_ratio == pytest.approx(ratios.max(), rel=1e-9)
    assert kept.duration > free.duration
    assert any(b.limit == "torque" for b in present(kept.timing).binding)


def test_a_torque_that_cannot_hold_the_arm_is_told_with_its_joint() -> None:
    limit = np.array([50.0, 1.0, 50.0, 50.0, 50.0, 50.0])
    with pytest.raises(TimingFailed) as caught:
        timed("ur5", {"torque": limit})
    assert (caught.value.limit, caught.value.joint) == ("torque", "shoulder_lift_joint")


@pytest.mark.parametrize("name", ["iiwa14", "dobot_magician", "tiago"])
def test_the_tool_keeps_its_speed_and_acceleration(name: str) -> None:
    robot = ikplan.load_robot(name).with_tool([0.0, 0.05, 0.2])
    limits = {
        "tool_speed": {"linear": 0.05, "angular": 0.3},
        "tool_acceleration": {"linear": 0.3, "angular": 2.0},
    }
    plan = ikplan.time_path(robot, path(name, 0.1), limits=limits)
    twist = np.array([robot.jacobian(q) @ dq for q, dq in zip(plan.q, plan.dq, strict=True)])
    linear, angular = (np.linalg.norm(twist[:, part], axis=1) for part in (slice(3), slice(3, 6)))
    share = np.maximum(linear / 0.05, angular / 0.3)
    assert 0.99 < share.max() <= 1.0
    assert plan.certificate.tool_speed_ratio == pytest.approx(share.max(), rel=1e-9)
    assert present(plan.certificate.tool_acceleration_ratio) <= 1.0
    # Against positions: second differences of the tool's place bound its mean acceleration.
    place = np.array([robot.fk(q).translation for q in plan.q])[:-1]
    rate = 250.0
    second = np.linalg.norm(np.diff(place, 2, axis=0), axis=1) * rate**2
    assert second.max() <= 0.3 * 1.001 + 1e-6


def test_jerk_is_limited_and_told_with_its_price() -> None:
    free = timed("iiwa14", {}, rate_hz=1000.0)
    plan = timed("iiwa14", {"jerk": 60.0}, rate_hz=1000.0)
    jerk = np.abs(np.diff(plan.ddq, axis=0)) / np.diff(plan.time)[:, None]
    assert 0.9 * 60.0 < jerk.max() <= 60.0
    assert plan.certificate.jerk_limited
    assert plan.certificate.jerk_limit_ratio == pytest.approx(jerk.max() / 60.0, rel=1e-9)
    assert present(plan.timing).unlimited_duration == pytest.approx(free.duration, rel=1e-3)
    assert plan.duration > free.duration
    assert not free.certificate.jerk_limited
    assert free.certificate.jerk_limit_ratio is None


def test_the_strictest_limit_holds_and_limits_may_differ_by_direction() -> None:
    robot = ikplan.load_robot("panda")
    limits = {"velocity": [0.4] * 7, "velocity_lower": -0.2, "acceleration": 1e6}
    plan = timed("panda", limits)
    assert plan.dq.max() <= 0.4
    assert -0.2 <= plan.dq.min() < -0.199
    assert (np.abs(plan.ddq) <= robot.acceleration_limit * (1 + 1e-9)).all()
    assert plan.certificate.velocity_limit_ratio == pytest.approx(1.0, abs=1e-3)


def test_the_binding_limits_share_the_time_and_a_wider_one_shortens_it() -> None:
    plan = timed("ur5", {"velocity_scale": 0.3})
    shares = [b.share for b in present(plan.timing).binding]
    assert sum(shares) == pytest.approx(1.0)
    assert shares == sorted(shares, reverse=True)
    wider = present(plan.timing).what_if[0]
    top = present(plan.timing).binding[0]
    assert (wider.limit, wider.joint) == (top.limit, top.joint)
    robot = ikplan.load_robot("ur5")
    limits = MotionLimits.of(robot, LimitOptions(velocity_scale=0.3))
    lists = {"velocity": limits.velocity.copy(), "acceleration": limits.acceleration.copy()}
    lists[wider.limit][robot.joint_names.index(wider.joint)] *= wider.factor
    # A robot with that limit wider: overrides can only make limits stricter.
    other = robot.with_limits(lists["velocity"], lists["acceleration"])
    assert ikplan.time_path(other, path("ur5")).duration == pytest.approx(wider.duration, rel=5e-3)
    assert wider.duration < plan.duration


@pytest.mark.parametrize("jerk", [None, 60.0])
def test_a_plan_can_be_evaluated_at_any_time(jerk: float | None) -> None:
    document = {"robot": "ur5", "waypoints": path("ur5"), "limits": {"jerk": jerk}}
    exact = ikplan.time_request({**document, "sampling": {"form": "polynomial"}})
    dense = ikplan.time_request({**document, "sampling": {"rate_hz": 4000}})
    coarse = ikplan.time_request(document)
    assert coarse.motion is None
    read = Plan.load(exact.model_dump_json())
    # The same motion, but for the grid that its end is on.
    slower = exact.duration / dense.duration
    moments = zip(read.at(dense.time * slower), (dense.q, dense.dq, dense.ddq), strict=True)
    for power, (mine, theirs) in enumerate(moments):
        np.testing.assert_allclose(mine[:-1] * slower**power, theirs[:-1], atol=2e-8)
    for mine, theirs in zip(coarse.at(coarse.time), (coarse.q, coarse.dq, coarse.ddq), strict=True):
        np.testing.assert_allclose(mine, theirs, atol=1e-12)
    np.testing.assert_allclose(coarse.at(dense.time * slower)[0], dense.q, atol=1e-4)
    q, dq, ddq = exact.at(1e9)
    assert q.shape == dq.shape == ddq.shape == (6,)
    np.testing.assert_allclose(q, exact.waypoints.q[-1], atol=1e-12)
    with pytest.raises(ikplan.InvalidRequest):
        exact.at([0.0, np.nan])


def test_knots_are_fewer_and_lie_on_the_motion() -> None:
    document = {"robot": "ur5", "waypoints": path("ur5")}
    exact = ikplan.time_request({**document, "sampling": {"form": "polynomial"}})
    knots = ikplan.time_request({**document, "sampling": {"form": "knots", "rate_hz": 125}})
    assert knots.duration == exact.duration
    assert (np.diff(knots.time) > 0.0).all()
    for mine, theirs in zip(exact.at(knots.time), (knots.q, knots.dq), strict=False):
        np.testing.assert_allclose(mine, theirs, atol=1e-9)


def test_a_corner_that_is_to_be_exact_comes_to_rest() -> None:
    robot = ikplan.load_robot("ur5")
    q = path("ur5", n=4)
    through, stopping = (ikplan.time_path(robot, q, rest_at=rest) for rest in ((), (1,)))
    assert stopping.duration > through.duration
    exact = ikplan.time_request(
        {"robot": "ur5", "waypoints": q, "rest_at": [1], "sampling": {"form": "polynomial"}}
    )
    _, dq, _ = exact.at(exact.waypoints.time[1])
    assert np.abs(dq).max() < 1e-9


def test_one_place_and_places_too_close_to_tell_apart_are_motions() -> None:
    robot = ikplan.load_robot("ur5")
    still = ikplan.time_path(robot, [robot.home, robot.home])
    assert still.duration == 0.0
    assert present(still.timing).binding == []
    tiny = ikplan.time_path(robot, [robot.home, robot.home + 1e-7])
    check_motion(tiny.trajectory, robot, ends=(robot.home, robot.home + 1e-7))
    close = [robot.home, robot.home, robot.home + 0.5, robot.home + 0.5 + 1e-12, robot.home]
    plan = ikplan.time_path(robot, close, limits={"jerk": 100.0})
    assert plan.waypoints.time[0] == plan.waypoints.time[1]


def test_the_phase_plane_bound_is_reached_and_never_passed() -> None:
    robot = ikplan.load_robot("panda")
    plan = timed("panda", {})
    limits = MotionLimits.of(robot, LimitOptions())
    bound = path_speed_bound(plan.dq, plan.ddq, limits)
    s, speed = path_speed(plan.time, plan.q, plan.dq)
    moving = np.isfinite(bound)
    share = speed[moving] / bound[moving]
    assert 0.98 < share.max() <= 1.0 + 1e-6
    assert (np.diff(s) > 0.0).all()


BROKEN: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "jerk": ({"jerk": 60.0}, {"jerk": 40.0}, "jerk limit of"),
    "torque": ({"torque": True}, {"torque": [20.0, 60.0, 20.0, 9.0, 9.0, 9.0]}, "torque limit of"),
    "payload": (
        {"torque": True},
        {"torque": True, "payload": {"mass": 60.0, "position": [0.0, 0.0, 0.3]}},
        "torque limit of",
    ),
    "tool speed": ({"tool_speed": 0.2}, {"tool_speed": 0.19}, "tool speed"),
    "tool turning": ({}, {"tool_speed": {"angular": 0.1}}, "tool speed"),
    "tool acceleration": ({}, {"tool_acceleration": 0.5}, "tool acceleration"),
    "lowest velocity": ({}, {"velocity_lower": -0.1}, "velocity limit of"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_the_certificate_finds_each_broken_promise(name: str) -> None:
    kept, promised, words = BROKEN[name]
    robot = ikplan.load_robot("ur5")
    plan = timed("ur5", kept)
    claim = Claim(
        robot, None, plan.q[0], plan.waypoints.q, plan.waypoints.time,
        plan.time, plan.q, plan.dq, plan.ddq,
        limits=MotionLimits.of(robot, LimitOptions(**kept)),
    )  # fmt: skip
    used = certify(claim)
    assert used.acceleration_limit_ratio == pytest.approx(limit_ratios(plan.trajectory, robot)[1])
    strict = LimitOptions.model_validate(promised)
    with pytest.raises(CertificateViolated) as caught:
        certify(replace(claim, limits=MotionLimits.of(robot, strict)))
    assert any(words in violation for violation in caught.value.violations)


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_the_figure_of_a_timing_is_the_same_bytes_each_time(suffix: str, tmp_path: Path) -> None:
    limits = {"tool_speed": {"linear": 0.3, "angular": 1.0}, "torque": True}
    plan = timed("ur5", limits)
    for i in range(2):
        plan.plot_timing(tmp_path / f"{i}{suffix}", limits)
    images = [(tmp_path / f"{i}{suffix}").read_bytes() for i in range(2)]
    assert images[0] == images[1]
    assert len(images[0]) > 10_000


def test_a_robot_without_inertias_has_a_figure_without_torques(tmp_path: Path) -> None:
    timed("iiwa14", {}).plot_timing(tmp_path / "timing.png")
    assert (tmp_path / "timing.png").stat().st_size > 10_000
