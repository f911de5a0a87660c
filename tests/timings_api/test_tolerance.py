"""Timings within a tolerance: noise costs no time, and the motion stays near the waypoints."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import ikplan
from ikplan.certificate import Claim, certify
from ikplan.documents.limits import LimitOptions
from ikplan.errors import CertificateViolated, InvalidRequest
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.polyline import Polyline
from ikplan.robots import Robot
from ikplan.smoothing import clusters_of, fit_within
from tests.present import present

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def robot() -> Robot:
    return ikplan.load_robot("ur5")


def smooth_rows(robot: Robot, count: int) -> Array:
    """A smooth motion of all joints, as a recorder at a fixed rate sees it."""
    x = np.linspace(0.0, 1.0, count)[:, None]
    share = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    swing = np.array([0.9, 0.4, -0.5, 0.3, 0.6, -0.8])
    wave = np.array([0.1, 0.0, 0.2, 0.1, 0.0, 0.2])
    return np.asarray(robot.home + share * swing + wave * np.sin(2.0 * np.pi * share))


def away_from_polyline(q: Array, rows: Array, places: int) -> float:
    """Largest joint distance of configurations from a polyline, by dense sampling."""
    shares = np.linspace(0.0, 1.0, places + 1)[:-1]
    legs = rows[:-1, None] + shares[:, None] * np.diff(rows, axis=0)[:, None]
    dense = np.vstack([legs.reshape(-1, rows.shape[1]), rows[-1:]])
    return float(max(np.abs(dense - one).max(axis=1).min() for one in q))


def test_noise_within_the_tolerance_costs_no_time(robot: Robot) -> None:
    rows = smooth_rows(robot, 600)
    noisy = rows + np.random.default_rng(5).uniform(-5e-5, 5e-5, size=rows.shape)
    clean = ikplan.time_path(robot, rows)
    followed = ikplan.time_path(robot, noisy)
    within = ikplan.time_path(robot, noisy, tolerance=2e-4)
    assert followed.duration > 2.0 * clean.duration
    assert within.duration == pytest.approx(clean.duration, rel=0.05)
    assert within.certificate.valid
    assert present(within.certificate.max_joint_deviation) <= 2e-4
    assert away_from_polyline(within.q[::7], noisy, 128) <= 2e-4 + 2e-5
    assert np.abs(within.waypoints.q - noisy).max() <= 2e-4
    assert np.array_equal(within.q[[0, -1]], noisy[[0, -1]])


def test_a_noisy_circle_that_bends_at_its_ends_takes_no_longer(robot: Robot) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 1000)[:, None]
    swing = np.array([0.3, 0.3, 0.0, 0.0, 0.0, 0.0])
    rows = robot.home + swing * np.sin(angle + np.array([0.0, np.pi / 2, 0, 0, 0, 0])) - swing / 2
    noisy = rows + np.random.default_rng(0).normal(0.0, 2.5e-5, size=rows.shape)
    clean = ikplan.time_path(robot, rows)
    within = ikplan.time_path(robot, noisy, tolerance=2e-4)
    # 1.34 where the spans at the ends are as long as the others.
    assert within.duration <= 1.02 * clean.duration
    assert present(within.certificate.max_joint_deviation) <= 2e-4


def test_noise_is_named_where_there_is_no_tolerance(robot: Robot) -> None:
    rows = smooth_rows(robot, 300)
    noisy = rows + np.random.default_rng(5).uniform(-5e-5, 5e-5, size=rows.shape)
    (hint,) = present(ikplan.time_path(robot, noisy).timing).hints
    assert "noisy" in hint
    assert "tolerance" in hint
    assert "shoulder_pan_joint" in hint
    assert present(ikplan.time_path(robot, rows).timing).hints == []


def test_the_tolerance_may_be_that_of_the_tool(robot: Robot) -> None:
    rows = smooth_rows(robot, 300)
    noisy = rows + np.random.default_rng(5).uniform(-5e-5, 5e-5, size=rows.shape)
    tolerance = {"position": 3e-4, "orientation": 1e-3}
    plan = ikplan.time_path(robot, noisy, tolerance=tolerance)
    assert plan.duration == pytest.approx(ikplan.time_path(robot, rows).duration, rel=0.05)
    assert present(plan.certificate.max_path_deviation) <= 3e-4
    assert present(plan.certificate.max_orientation_deviation) <= 1e-3
    asked = np.array([robot.fk(q).translation for q in noisy])
    passed = np.array([robot.fk(q).translation for q in plan.waypoints.q])
    assert np.linalg.norm(asked - passed, axis=1).max() <= 3e-4


def test_a_dwell_and_a_turn_back_in_noise_are_passed(robot: Robot) -> None:
    there = smooth_rows(robot, 200)
    rows = np.vstack([there, np.repeat(there[-1:], 80, axis=0), there[::-1]])
    noisy = rows + np.random.default_rng(2).uniform(-5e-5, 5e-5, size=rows.shape)
    plan = ikplan.time_path(robot, noisy, tolerance=2e-4)
    once = ikplan.time_path(robot, there)
    assert plan.duration == pytest.approx(2.0 * once.duration, rel=0.05)
    assert present(plan.certificate.max_joint_deviation) <= 2e-4
    (stop,) = plan.certificate.stops
    assert stop == pytest.approx(0.5 * plan.duration, abs=0.02)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-2, 5e-2])
def test_sparse_waypoints_are_joined_near_the_polyline(robot: Robot, tolerance: float) -> None:
    rows = robot.home + np.random.default_rng(11).uniform(-0.5, 0.5, size=(6, 6))
    plan = ikplan.time_path(robot, rows, tolerance=tolerance)
    stopping = ikplan.time_path(robot, rows, rest_at=range(6))
    spline = ikplan.time_path(robot, rows)
    assert present(plan.certificate.max_joint_deviation) <= tolerance
    assert away_from_polyline(plan.q[::5], rows, 1000) <= tolerance + 5e-4
    assert plan.duration <= stopping.duration + 0.008
    # A spline through the waypoints swings out, and its certificate says so.
    assert present(spline.certificate.max_joint_deviation) > 0.01
    assert present(stopping.certificate.max_joint_deviation) < 1e-9


def test_the_deviation_of_the_tool_from_the_polyline_is_told(robot: Robot) -> None:
    rows = robot.home + np.array([[0.0] * 6, [0.4, 0, 0, 0, 0, 0], [0.4, 0.4, 0, 0, 0, 0]])
    plan = ikplan.time_path(robot, rows)
    # By Pinocchio, against the tool all along the polyline.
    line = np.vstack([np.linspace(a, b, 400) for a, b in itertools.pairwise(rows)])
    on_line = np.array([robot.fk(q).translation for q in line])
    samples = np.array([robot.fk(q).translation for q in plan.q])
    away = max(np.linalg.norm(on_line - p, axis=1).min() for p in samples)
    assert present(plan.certificate.max_path_deviation) >= away - 1e-4
    assert present(plan.certificate.max_path_deviation) < 4.0 * away
    assert plan.certificate.max_joint_deviation == pytest.approx(
        max(np.abs(line - q).max(axis=1).min() for q in plan.q), abs=1e-3
    )


def test_limits_of_segments_and_rests_hold_within_a_tolerance(robot: Robot) -> None:
    rows = smooth_rows(robot, 200)
    noisy = rows + np.random.default_rng(5).uniform(-5e-5, 5e-5, size=rows.shape)
    segment = {"first": 60, "last": 140, "limits": {"velocity": 0.2}}
    plan = ikplan.time_path(robot, noisy, tolerance=2e-4, segments=[segment], rest_at=[150])
    (part,) = plan.certificate.segments
    assert part.velocity_limit_ratio == pytest.approx(1.0, abs=0.01)
    assert np.array_equal(plan.waypoints.q[150], noisy[150])
    (stop,) = plan.certificate.stops
    assert stop == pytest.approx(plan.waypoints.time[150], abs=1e-9)


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, [1e-3, 1e-3], {"position": 0.0}])
def test_a_tolerance_that_is_none_is_refused(robot: Robot, tolerance: Any) -> None:
    with pytest.raises(InvalidRequest, match="tolerance"):
        ikplan.time_path(robot, smooth_rows(robot, 5), tolerance=tolerance)


def claim_of(robot: Robot, plan: ikplan.Plan, rows: Array, tolerance: float) -> Claim:
    return Claim(
        robot=robot,
        path=None,
        q_start=rows[0],
        waypoint_q=plan.waypoints.q,
        waypoint_time=plan.waypoints.time,
        time=plan.time,
        q=plan.q,
        dq=plan.dq,
        ddq=plan.ddq,
        limits=MotionLimits.of(robot, LimitOptions()),
        joint_waypoints=rows,
        joint_tolerance=tolerance,
    )


def test_the_certificate_refuses_a_motion_off_the_polyline(robot: Robot) -> None:
    rows = smooth_rows(robot, 40)
    plan = ikplan.time_path(robot, rows, tolerance=1e-3)
    claim = claim_of(robot, plan, rows, 1e-3)
    assert certify(claim).valid
    moved = rows.copy()
    moved[20, 2] += 3e-3
    with pytest.raises(CertificateViolated, match="polyline"):
        certify(replace(claim, joint_waypoints=moved))
    with pytest.raises(CertificateViolated, match="waypoint 20"):
        certify(replace(claim, joint_waypoints=moved))
    with pytest.raises(CertificateViolated, match="does not rest"):
        certify(replace(claim, stop_time=np.array([0.5 * plan.duration])))


def test_the_nearest_place_of_a_leg_is_the_nearest() -> None:
    rng = np.random.default_rng(3)
    rows, weight = rng.normal(size=(2, 5)), rng.uniform(0.5, 2.0, size=5)
    q = rows[0] + rng.normal(size=(30, 5))
    near = Polyline(rows, weight).nearest(q, np.zeros(30, dtype=np.int64))
    dense = rows[0] + np.linspace(0.0, 1.0, 4001)[:, None] * (rows[1] - rows[0])
    for one, place in zip(q, near, strict=True):
        best = (np.abs(dense - one) / weight).max(axis=1).min()
        assert (np.abs(place - one) / weight).max() == pytest.approx(best, abs=1e-3)


def test_a_fit_is_in_its_boxes_and_a_line_where_one_fits() -> None:
    rng = np.random.default_rng(8)
    points = np.linspace(0.0, 1.0, 300)[:, None] * np.array([1.0, -2.0])
    noisy = points + rng.uniform(-1e-3, 1e-3, size=points.shape)
    clusters = clusters_of(noisy, np.full(2, 2e-3))
    spline = fit_within(clusters.u, clusters.middle, clusters.half_width)
    fitted = spline(clusters.u[clusters.of_point])
    assert np.abs(fitted - noisy).max() <= 2e-3 * (1.0 + 1e-9)
    line = np.linspace(0.0, 1.0, 200)[:, None] * (noisy[-1] - noisy[0]) + noisy[0]
    curve = spline(np.linspace(0.0, clusters.u[-1], 200))
    assert np.abs(curve - line).max() < 2e-3
    assert np.array_equal(spline(clusters.u[[0, -1]]), clusters.middle[[0, -1]])


def test_points_within_the_tolerance_are_one_cluster() -> None:
    points = np.array([[0.0], [0.4], [0.9], [2.0], [2.1], [2.0], [5.0]])
    clusters = clusters_of(points, np.ones(1))
    assert clusters.of_point.tolist() == [0, 0, 0, 1, 1, 1, 2]
    assert (np.diff(clusters.u) > 0.0).all()
    for point, k in zip(points, clusters.of_point, strict=True):
        off = np.abs(clusters.middle[k] - point) + clusters.half_width[k]
        assert off <= 1.0 + 1e-12 or k == 0
