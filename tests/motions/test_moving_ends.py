"""Motions that begin or end moving."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan

HOME = np.array([0.0, -1.2, 1.5, -1.8, -1.5, 0.2])
STEPS = [[0.0] * 6, [0.4, 0.3, -0.2, 0.1, 0.2, -0.3], [0.8, -0.1, 0.3, 0.0, 0.0, 1.0]]
WAYPOINTS = HOME + np.array(STEPS)
START, END = np.full(6, 0.8), np.array([0.5, -0.4, 0.3, 0.0, 0.2, -0.5])
JERKS: list[Any] = [False, 60.0]


def the_robot() -> ikplan.Robot:
    return ikplan.load_robot("ur5")


def largest_jerk(plan: ikplan.Plan) -> float:
    return float((np.abs(np.diff(plan.ddq, axis=0)) / np.diff(plan.time)[:, None]).max())


@pytest.mark.parametrize("jerk", JERKS)
def test_velocities_at_both_ends_are_met_and_limits_hold(jerk: Any) -> None:
    robot = the_robot()
    plan = ikplan.time_path(
        robot, WAYPOINTS, limits={"jerk": jerk}, start_velocity=START, end_velocity=END
    )
    assert np.abs(plan.dq[0] - START).max() <= 1e-9
    assert np.abs(plan.dq[-1] - END).max() <= 1e-9
    assert plan.certificate.valid
    assert (np.abs(plan.ddq) <= robot.acceleration_limit * (1 + 1e-9)).all()
    assert plan.timing is not None
    assert plan.timing.rate_hz is not None
    assert (plan.duration * plan.timing.rate_hz) % 1.0 == pytest.approx(0.0, abs=1e-6)
    if jerk:
        assert largest_jerk(plan) <= jerk * (1 + 1e-9)
        assert np.abs(plan.ddq[0]).max() <= 1e-6


def test_an_acceleration_at_the_start_is_met_under_jerk_limits() -> None:
    pull = np.array([1.0, -0.5, 0.2, 0.0, 0.3, 0.1])
    plan = ikplan.time_path(
        the_robot(),
        WAYPOINTS,
        limits={"jerk": 60.0},
        start_velocity=START,
        start_acceleration=pull,
    )
    assert np.abs(plan.ddq[0] - pull).max() <= 1e-6
    assert np.abs(plan.dq[0] - START).max() <= 1e-9


def test_a_motion_that_begins_as_fast_as_it_would_be_is_shorter_than_one_from_rest() -> None:
    robot = the_robot()
    from_rest = ikplan.time_path(robot, WAYPOINTS)
    ahead = 0.5 * from_rest.dq[np.argmax(np.abs(from_rest.dq[:, 0]))]
    moving = ikplan.time_path(robot, WAYPOINTS, start_velocity=ahead)
    assert moving.duration < from_rest.duration


@pytest.mark.parametrize("jerk", JERKS)
def test_what_is_not_feasible_is_refused_with_the_nearest_that_is(jerk: Any) -> None:
    robot = the_robot()
    wanted = 2.0 * robot.velocity_limit
    with pytest.raises(ikplan.TimingFailed) as refused:
        ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk}, start_velocity=wanted)
    nearest = refused.value.nearest["start_velocity"]
    assert refused.value.repairs[0]["change"] == {"start_velocity": nearest}
    plan = ikplan.time_path(robot, WAYPOINTS, limits={"jerk": jerk}, start_velocity=nearest)
    assert np.abs(plan.dq[0] - nearest).max() <= 1e-9


def test_a_start_too_near_to_a_position_limit_is_refused() -> None:
    robot = the_robot()
    near = WAYPOINTS.copy()
    near[0, 5] = robot.upper[5] - 1e-3
    speed = np.array([0.0, 0, 0, 0, 0, 2.0])
    with pytest.raises(ikplan.TimingFailed) as refused:
        ikplan.time_path(robot, near, start_velocity=speed)
    slower = np.array(refused.value.nearest["start_velocity"])
    assert 0.0 < slower[5] < 0.3
    ikplan.time_path(robot, near, start_velocity=slower)


def test_a_list_of_another_length_and_an_acceleration_at_rest_are_refused() -> None:
    wrongs: list[dict[str, Any]] = [{"start_velocity": [1.0]}, {"start_acceleration": [1.0] * 6}]
    for wrong in wrongs:
        with pytest.raises(ikplan.InvalidRequest) as refused:
            ikplan.time_path(the_robot(), WAYPOINTS, **wrong)
        assert refused.value.field == next(iter(wrong))


def line(**fields: Any) -> dict[str, Any]:
    down = {"quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]}
    begin = {"position": [0.4, -0.2, 0.3], **down}
    to = {"position": [0.4, 0.2, 0.3], **down}
    return {
        "robot": "ur5",
        "start": "free",
        "path": {"begin": begin, "segments": [{"type": "line", "to": to}]},
        "scene": {"self_collision": False},
        **fields,
    }


def test_a_tool_line_goes_on_from_its_middle_without_a_stop() -> None:
    whole = ikplan.plan(line(limits={"tool_speed": 0.1}))
    k = len(whole.time) // 2
    rest = line(
        start=whole.q[k].tolist(), start_velocity=whole.dq[k].tolist(), limits={"tool_speed": 0.1}
    )
    del rest["path"]["begin"]
    plan = ikplan.plan(rest)
    assert np.abs(plan.dq[0] - whole.dq[k]).max() <= 1e-9
    assert plan.duration == pytest.approx(whole.duration - whole.time[k], abs=0.02)
    across = dict(rest, start_velocity=[0.3, 0, 0, 0, 0, 0])
    with pytest.raises(ikplan.TimingFailed) as refused:
        ikplan.plan(across)
    assert ikplan.plan(dict(rest, **refused.value.nearest)).certificate.valid


def test_a_plan_of_joint_motions_begins_moving() -> None:
    request = {
        "robot": "ur5",
        "start": HOME.tolist(),
        "start_velocity": START.tolist(),
        "path": {"segments": [{"type": "joint", "q": (HOME + 0.4).tolist()}]},
    }
    plan = ikplan.plan(request)
    assert np.abs(plan.dq[0] - START).max() <= 1e-9
    assert plan.certificate.clearance is not None
