"""Limits of single segments: kept there and only there, certified, refused with their field."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import CertificateViolated, InvalidRequest, Plan
from ikplan.certificate import Claim, RequestedSegment, certify
from ikplan.documents.limits import LimitOptions, Payload, SegmentLimits
from ikplan.limits.motion_limits import MotionLimits
from tests.present import present

DOWN = [1.0, 0.0, 0.0, 0.0]


def corner(x: float, y: float, z: float) -> dict[str, Any]:
    return {"position": [x, y, z], "quaternion_xyzw": DOWN}


def request(blend: float = 0.0) -> dict[str, Any]:
    """Three lines, an arc of joints between; the second line is slow, the joints weak."""
    return {
        "robot": "panda",
        "start": "free",
        "path": {
            "begin": corner(0.5, -0.2, 0.4),
            "blend": blend,
            "segments": [
                {"type": "line", "to": corner(0.5, 0.0, 0.4)},
                {"type": "line", "to": corner(0.4, 0.1, 0.4), "limits": {"tool_speed": 0.05}},
                {"type": "line", "to": corner(0.4, 0.2, 0.3)},
                {
                    "type": "joint",
                    "q": [0.3, -0.4, 0.1, -2.2, 0.1, 1.8, 0.8],
                    "limits": {"velocity_scale": 0.1, "acceleration": 2.0},
                },
            ],
        },
        "limits": {"tool_speed": 0.3},
    }


def tool_speed(plan: Plan) -> np.ndarray:
    robot = ikplan.load_robot(plan.robot)
    return np.array(
        [
            np.linalg.norm((robot.jacobian(q) @ dq)[:3])
            for q, dq in zip(plan.q, plan.dq, strict=True)
        ]
    )


@pytest.mark.parametrize("blend", [0.0, 0.03])
def test_a_segment_keeps_its_limits_and_the_others_do_not_have_them(blend: float) -> None:
    plan = ikplan.plan(request(blend))
    robot, speed = ikplan.load_robot("panda"), tool_speed(plan)
    line, joints = plan.certificate.segments
    assert (line.field, joints.field) == ("path.segments[1]", "path.segments[3]")
    slow = (plan.time > line.begin) & (plan.time < line.end)
    assert 0.0499 < speed[slow].max() <= 0.05
    assert line.tool_speed_ratio == pytest.approx(speed[slow].max() / 0.05, rel=1e-9)
    before = plan.time < line.begin
    assert 0.29 < speed[before].max() <= 0.3
    last = plan.time > joints.begin
    share = np.abs(plan.dq) / robot.velocity_limit
    assert 0.099 < share[last].max() <= 0.1
    assert share[~last].max() > 0.11
    assert np.abs(plan.ddq[last]).max() <= 2.0 * (1.0 + 1e-9)
    assert joints.end == plan.duration
    # Every place of the slow line is in its window: as long as its 0.14 m take, corners included.
    assert line.end - line.begin >= 0.14 / 0.05 - 0.1
    if blend == 0.0:
        times = plan.waypoints.time
        assert (line.begin, line.end) == (times[1], times[2])


def test_the_strictest_of_both_holds_and_wider_ones_change_nothing() -> None:
    document = request()
    plain = copy.deepcopy(document)
    for segment in plain["path"]["segments"]:
        segment.pop("limits", None)
    wide = copy.deepcopy(plain)
    wide["path"]["segments"][0]["limits"] = {"tool_speed": 5.0, "velocity": 1e3}
    assert ikplan.plan(wide).duration == pytest.approx(ikplan.plan(plain).duration, rel=1e-3)
    assert ikplan.plan(document).duration > 1.3 * ikplan.plan(plain).duration


RETIMED = {"first": 2, "last": 4, "limits": {"tool_speed": 0.05, "velocity_scale": 0.3}}


def walk(name: str) -> np.ndarray:
    robot = ikplan.load_robot(name)
    rng = np.random.default_rng(5)
    steps = np.vstack([np.zeros(robot.dof), 0.2 * (rng.random((5, robot.dof)) - 0.5)])
    return robot.clip(robot.home) + steps


@pytest.mark.parametrize("jerk", [False, 100.0])
@pytest.mark.parametrize("name", ["panda", "kinova_j2s6s200"])
def test_a_part_of_a_joint_path_keeps_its_limits(name: str, jerk: float | bool) -> None:
    robot = ikplan.load_robot(name)
    plan = ikplan.time_path(robot, walk(name), limits={"jerk": jerk}, segments=[RETIMED])
    (part,) = plan.certificate.segments
    inside = (plan.time > part.begin) & (plan.time < part.end)
    speed = tool_speed(plan)
    assert (part.begin, part.end) == (plan.waypoints.time[2], plan.waypoints.time[4])
    assert 0.99 * 0.05 < speed[inside].max() <= 0.05
    assert speed[~inside].max() > 0.06
    assert (np.abs(plan.dq[inside]) <= 0.3 * robot.velocity_limit).all()
    assert plan.certificate.tool_speed_ratio is None
    assert plan.certificate.jerk_limited == (jerk is not False)
    assert any(b.limit == "tool_linear_speed" for b in present(plan.timing).binding)


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_jerk_is_limited_on_a_part_and_not_on_the_rest(name: str) -> None:
    robot, limit = ikplan.load_robot(name), 60.0
    part = {"first": 2, "last": 4, "limits": {"jerk": limit}}
    plan = ikplan.time_path(
        robot, walk(name), rate_hz=1000.0, limits={"jerk": False}, segments=[part]
    )
    (certified,) = plan.certificate.segments
    jerk = np.abs(np.diff(plan.ddq, axis=0)) / np.diff(plan.time)[:, None]
    inside = (plan.time[:-1] > certified.begin) & (plan.time[1:] < certified.end)
    assert 0.9 * limit < jerk[inside].max() <= limit
    assert certified.jerk_limit_ratio == pytest.approx(jerk[inside].max() / limit, rel=1e-6)
    assert jerk[~inside].max() > 2.0 * limit
    assert not plan.certificate.jerk_limited
    free = ikplan.time_path(robot, walk(name), limits={"jerk": False})
    whole = ikplan.time_path(robot, walk(name), limits={"jerk": limit})
    assert free.duration < plan.duration < whole.duration
    assert present(plan.timing).unlimited_duration == pytest.approx(free.duration, rel=1e-2)


def test_a_jerk_limit_of_a_part_stops_the_motion_at_steps_of_the_curvature_there_only() -> None:
    # A spline that is bent to stay within position limits: its curvature steps at waypoints.
    robot = ikplan.load_robot("panda")
    q = np.tile(robot.home, (7, 1))
    q[:, 0] += 0.3 * np.arange(7)
    q[[1, 3, 5], 3] = robot.upper[3]
    stops = []
    for first, last in ((0, 6), (0, 3), (3, 6)):
        part = {"first": first, "last": last, "limits": {"jerk": 200.0}}
        plan = ikplan.time_path(robot, q, rate_hz=1000.0, limits={"jerk": False}, segments=[part])
        at = [int(np.argmin(np.abs(plan.time - t))) for t in plan.waypoints.time[1:-1]]
        stops.append({k + 1 for k, row in enumerate(at) if np.abs(plan.dq[row]).max() < 0.02})
    assert stops[0] >= stops[1] | stops[2]
    assert stops[1]
    assert max(stops[1]) <= 3
    assert min(stops[2]) >= 3


def test_a_payload_on_a_part_is_carried_there_only() -> None:
    robot, mass = ikplan.load_robot("panda"), 3.0
    q = walk("panda")
    bare = ikplan.time_path(robot, q, limits={"torque": True})
    limits = {"torque": True, "payload": {"mass": mass, "position": [0.0, 0.0, 0.3]}}
    plan = ikplan.time_path(
        robot, q, limits={"torque": True}, segments=[{"first": 2, "last": 4, "limits": limits}]
    )
    (part,) = plan.certificate.segments
    inside = (plan.time > part.begin) & (plan.time < part.end)
    load = np.zeros_like(plan.q)
    for row in np.flatnonzero(inside):
        T, lift = robot.fk(plan.q[row]), np.array([0.0, 0.0, 9.81 * mass])
        at_tool = T.rotation.T @ lift
        force = np.concatenate([at_tool, np.cross([0.0, 0.0, 0.3], at_tool)])
        load[row] = robot.jacobian(plan.q[row]).T @ force
    # Its weight alone is within the limits, and what the certificate saw is more than without.
    assert (np.abs(load) < robot.effort_limit).all()
    assert part.torque_limit_ratio is not None
    assert bare.certificate.torque_limit_ratio is not None
    assert part.torque_limit_ratio <= 1.0 + 1e-9
    again = ikplan.time_path(robot, q, limits={"torque": True}, segments=[])
    assert again.duration == bare.duration
    heavy = ikplan.time_path(robot, q, limits=limits)
    assert bare.duration <= plan.duration <= heavy.duration * (1.0 + 1e-6)
    loaded = heavy.certificate.torque_limit_ratio
    assert loaded is not None
    assert loaded >= part.torque_limit_ratio * (1.0 - 1e-2)


def test_parts_may_overlap_and_need_not_have_a_length() -> None:
    robot, q = ikplan.load_robot("ur5"), walk("ur5")
    parts = [
        {"first": 0, "last": 5, "limits": {"tool_speed": 0.2}},
        {"first": 1, "last": 3, "limits": {"tool_speed": {"angular": 0.4}, "torque": True}},
        {"first": 2, "last": 3, "limits": {"tool_acceleration": 0.5, "velocity": 0.3}},
    ]
    plan = ikplan.time_path(robot, q, segments=parts)
    ratios = [(s.tool_speed_ratio, s.torque_limit_ratio) for s in plan.certificate.segments]
    assert [torque is None for _, torque in ratios] == [True, False, True]
    assert present(plan.certificate.segments[2].tool_acceleration_ratio) <= 1.0
    twice = np.repeat(q, 2, axis=0)
    spot = [{"first": 2, "last": 3, "limits": {"velocity": 0.01}}]
    assert ikplan.time_path(robot, twice, segments=spot).duration == pytest.approx(
        ikplan.time_path(robot, twice).duration
    )


def test_many_parts_cost_no_more_rows_than_meet() -> None:
    robot = ikplan.load_robot("ur5")
    turn = np.linspace(0.0, 12.0, 121)[:, None]
    q = robot.home + 0.3 * np.sin(turn + np.arange(6))
    parts = [
        {"first": k, "last": k + 1, "limits": {"tool_speed": 0.1 + 0.01 * (k % 7)}}
        for k in range(120)
    ]
    plan = ikplan.time_path(robot, q, segments=parts)
    assert len(plan.certificate.segments) == 120
    assert max(s.tool_speed_ratio or 0.0 for s in plan.certificate.segments) <= 1.0


def test_the_certificate_finds_a_segment_that_breaks_its_limits() -> None:
    robot = ikplan.load_robot("panda")
    plan = ikplan.time_path(robot, walk("panda"))
    limits = MotionLimits.of(robot, LimitOptions())
    claim = Claim(
        robot, None, plan.q[0], plan.waypoints.q, plan.waypoints.time,
        plan.time, plan.q, plan.dq, plan.ddq, limits,
    )  # fmt: skip
    for options, words in (
        (SegmentLimits(tool_speed=0.05), "segments[0]: the tool speed"),
        (SegmentLimits(velocity_scale=0.05), "segments[0]: the velocity limit of"),
        (SegmentLimits(acceleration=0.05), "segments[0]: the acceleration limit of"),
        (SegmentLimits(torque=[1.0] * 7), "segments[0]: the torque limit of"),
        (SegmentLimits(jerk=0.1), "segments[0]: the jerk limit of"),
        (
            SegmentLimits(torque=True, payload=Payload(mass=200.0)),
            "segments[0]: the torque limit of",
        ),
    ):
        part = RequestedSegment("segments[0]", 2, 4, options)
        with pytest.raises(CertificateViolated) as caught:
            certify(replace(claim, segments=(part,)))
        assert any(violation.startswith(words) for violation in caught.value.violations)


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "zero": ({"velocity": 0.0}, "limits.velocity"),
    "negative speed": ({"tool_speed": -1.0}, "limits.tool_speed"),
    "length": ({"velocity": [1.0, 1.0]}, "limits.velocity"),
    "scale": ({"velocity_scale": 2.0}, "limits.velocity_scale"),
    "jerk": ({"jerk": [10.0, 20.0]}, "limits.jerk"),
    "payload": ({"payload": {"mass": 1.0}}, "limits.payload"),
    "torque": ({"torque": True}, "limits.torque"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_limits_of_a_segment_are_refused_with_their_field(name: str) -> None:
    limits, field = WRONG[name]
    robot = "iiwa14" if name == "torque" else "panda"
    document = {**request(), "robot": robot}
    document["path"]["segments"][1]["limits"] = limits
    with pytest.raises(InvalidRequest) as caught:
        ikplan.plan(document)
    assert caught.value.field == f"path.segments[1].{field}"
    assert caught.value.field in caught.value.detail
    part = {"first": 0, "last": 2, "limits": limits}
    q = [[0.0] * 7, [0.1] * 7, [0.2] * 7]
    if robot == "panda":
        q = (np.array(q) + ikplan.load_robot("panda").home).tolist()
    with pytest.raises(InvalidRequest) as caught:
        ikplan.time_request({"robot": robot, "waypoints": q, "segments": [part]})
    assert caught.value.field == f"segments[0].{field}"


@pytest.mark.parametrize(("first", "last"), [(2, 2), (3, 1), (0, 9), (-1, 2)])
def test_a_part_must_lead_from_a_waypoint_to_a_later_one(first: int, last: int) -> None:
    part = {"first": first, "last": last, "limits": {}}
    document = {"robot": "ur5", "waypoints": walk("ur5"), "segments": [part]}
    with pytest.raises(InvalidRequest, match=r"segments\[0\]"):
        ikplan.time_request(document)
