"""Motions that take a given time, stand for a while, and tell when they pass places."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from tests.motions.test_moving_ends import END, JERKS, START, WAYPOINTS, line, the_robot

DOWN = {"quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]}


@pytest.mark.parametrize("jerk", JERKS)
@pytest.mark.parametrize("moving", [False, True])
def test_a_duration_is_met_and_the_path_kept(jerk: Any, moving: bool) -> None:
    rates: dict[str, Any] = {"start_velocity": START, "end_velocity": END} if moving else {}
    robot, limits = the_robot(), {"jerk": jerk}
    free = ikplan.time_path(robot, WAYPOINTS, limits=limits, **rates)
    wanted = 1.37 * free.duration + 0.0011
    slow = ikplan.time_path(robot, WAYPOINTS, limits={**limits, "duration": wanted}, **rates)
    assert slow.duration == pytest.approx(wanted, abs=1e-9)
    assert np.abs(slow.waypoints.q - WAYPOINTS).max() <= 1e-12
    if not moving:
        share = np.interp(slow.time / slow.duration, free.time / free.duration, free.q[:, 0])
        assert np.abs(share - slow.q[:, 0]).max() <= 1e-3


@pytest.mark.parametrize("jerk", JERKS)
def test_too_short_a_duration_is_refused_with_the_least_one(jerk: Any) -> None:
    robot = the_robot()
    with pytest.raises(ikplan.TimingFailed) as refused:
        ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk, "duration": 0.1})
    least = refused.value.nearest["limits"]["duration"]
    plan = ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk, "duration": least})
    assert plan.duration == pytest.approx(least, abs=1e-9)
    free = ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk})
    assert least <= free.duration + 1e-9


def corner(**fields: Any) -> dict[str, Any]:
    request = line(**fields)
    first = request["path"]["segments"][0]
    second = {"type": "line", "to": {"position": [0.45, 0.2, 0.35], **DOWN}}
    request["path"]["segments"] = [first, second]
    return request


@pytest.mark.parametrize("jerk", JERKS)
def test_the_motion_stands_at_a_waypoint_for_its_dwell(jerk: Any) -> None:
    request = corner(limits={"jerk": jerk})
    request["path"]["segments"][0]["dwell"] = 0.5
    request["path"]["segments"][1]["dwell"] = 0.2
    plan = ikplan.plan(request)
    without = corner(limits={"jerk": jerk})
    without["path"]["segments"][0]["blend"] = 0.0
    free = ikplan.plan(without)
    assert plan.duration == pytest.approx(free.duration + 0.7, abs=0.009)
    arrives = plan.waypoints.time[1]
    stands = (plan.time >= arrives) & (plan.time <= arrives + 0.5)
    assert stands.sum() >= 60
    assert not np.abs(plan.dq[stands]).max() > 1e-9
    assert plan.certificate.stops == pytest.approx([arrives])
    q, dq, _ = plan.at(arrives + 0.25)
    assert np.abs(q - plan.waypoints.q[1]).max() <= 1e-9
    assert np.abs(dq).max() <= 1e-9


def test_a_rounded_corner_is_no_place_to_stand_at() -> None:
    request = corner()
    request["path"]["segments"][0] |= {"dwell": 0.5, "blend": 0.01}
    with pytest.raises(ikplan.InvalidRequest):
        ikplan.plan(request)


def test_events_are_where_they_are_asked_for() -> None:
    events: list[dict[str, Any]] = [
        {"name": "on", "segment": 0, "distance": 0.1},
        {"name": "off", "segment": 0, "distance": -0.05},
        {"name": "late", "segment": 1, "distance": 0.01},
        {"name": "then", "time": 0.3},
        {"name": "last", "time": -0.1},
    ]
    request = corner(events=events, limits={"tool_speed": 0.2}, sampling={"form": "polynomial"})
    request["path"]["segments"][0]["blend"] = 0.0
    plan = ikplan.plan(request)
    robot = the_robot()
    along = np.array([0.05, 0.0, 0.05]) / np.hypot(0.05, 0.05)
    wanted = [
        np.array([0.4, -0.1, 0.3]),
        np.array([0.4, 0.15, 0.3]),
        np.array([0.4, 0.2, 0.3]) + 0.01 * along,
    ]
    for event, place in zip(plan.events, wanted, strict=False):
        q, _, _ = plan.at(event.time)
        assert np.linalg.norm(robot.fk(q).translation - place) <= 1e-6
        assert event.position_error is not None
        assert event.position_error <= 1e-6
    assert [event.name for event in plan.events] == [event["name"] for event in events]
    assert plan.events[3].time == 0.3
    assert plan.events[4].time == pytest.approx(plan.duration - 0.1)


def test_an_event_beyond_its_segment_is_refused() -> None:
    for event in ({"segment": 0, "distance": 0.5}, {"segment": 7, "time": 0.0}, {"time": 99.0}):
        with pytest.raises(ikplan.InvalidRequest) as refused:
            ikplan.plan(corner(events=[{"name": "x", **event}]))
        assert str(refused.value.field).startswith("events[0]")


@pytest.mark.parametrize("jerk", JERKS)
def test_waypoints_are_passed_at_their_times_without_stops(jerk: Any) -> None:
    robot = the_robot()
    times = [0.0, 1.2345678901, 2.5]
    plan = ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk}, times=times)
    assert np.abs(plan.waypoints.time - times).max() <= 1e-9
    assert plan.certificate.stops == []
    assert plan.duration == pytest.approx(2.5, abs=1e-9)


@pytest.mark.parametrize("jerk", JERKS)
def test_times_that_are_too_early_are_refused_with_feasible_ones(jerk: Any) -> None:
    robot = the_robot()
    with pytest.raises(ikplan.TimingFailed) as refused:
        ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk}, times=[0.0, 0.1, 0.2])
    times = refused.value.nearest["times"]
    plan = ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk}, times=times)
    assert np.abs(plan.waypoints.time - times).max() <= 1e-9


def test_a_late_waypoint_and_times_left_open_are_passed() -> None:
    robot = the_robot()
    four = np.vstack([WAYPOINTS, WAYPOINTS[:1]])
    plan = ikplan.time_path(robot, four, times=[0.0, None, 1.4, 9.0])
    assert plan.waypoints.time[[0, 2, 3]] == pytest.approx([0.0, 1.4, 9.0], abs=1e-9)


def test_times_that_make_no_sense_are_refused() -> None:
    for times in ([0.0, 1.0], [0.0, 2.0, 1.0], [1.0, 2.0, 3.0], [0.0, 1.0, None]):
        with pytest.raises(ikplan.InvalidRequest):
            ikplan.time_path(the_robot(), WAYPOINTS, times=times)


def test_a_moving_start_keeps_the_times() -> None:
    times = [0.0, 0.9, 2.0]
    plan = ikplan.time_path(the_robot(), WAYPOINTS, times=times, start_velocity=0.2 * START)
    assert np.abs(plan.dq[0] - 0.2 * START).max() <= 1e-9
    assert np.abs(plan.waypoints.time - times).max() <= 1e-9
