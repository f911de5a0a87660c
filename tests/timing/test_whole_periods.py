"""A motion whose duration is a whole number of sample periods takes no period more."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ikplan.errors import TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.pipeline.retime import time_request
from ikplan.timing import ToolLimits, sample, time_joint_path

RATE = 1000.0


def _limits(acceleration: float, jerk: float | None = None) -> JointLimits:
    return JointLimits(
        lower=np.array([-50.0]),
        upper=np.array([50.0]),
        velocity=np.array([50.0]),
        acceleration=np.array([acceleration]),
        jerk=None if jerk is None else np.array([jerk]),
        joint_names=("joint",),
    )


@pytest.mark.parametrize("acceleration", [2.5, 7.3, 10.0])
@pytest.mark.parametrize("count", [23, 200, 611])
def test_a_move_of_whole_periods_ends_with_the_last_of_them(
    count: int, acceleration: float
) -> None:
    duration, limits = count / RATE, _limits(acceleration)
    distance = 0.25 * acceleration * duration**2
    samples = sample(time_joint_path(JointPath.through([[0.0], [distance]], limits), limits), RATE)
    assert len(samples.time) == count + 1
    assert samples.time[-1] == duration
    assert np.abs(samples.ddq).max() <= acceleration * (1.0 + 1e-12)
    assert samples.q[-1, 0] == distance


@pytest.mark.parametrize("jerk", [10.0, 33.7])
@pytest.mark.parametrize("count", [40, 400, 1201])
def test_so_does_a_jerk_limited_move(count: int, jerk: float) -> None:
    duration, limits = count / RATE, _limits(1e3, jerk)
    distance = jerk * duration**3 / 32.0  # four phases at the jerk limit
    timed = time_joint_path(JointPath.through([[0.0], [distance]], limits), limits)
    samples = sample(timed, RATE)
    assert len(samples.time) == count + 1
    change = np.abs(np.diff(samples.ddq[:, 0])) * RATE
    assert change.max() <= jerk * (1.0 + 1e-9)


def test_moves_with_stops_between_end_with_a_period_too() -> None:
    limits = _limits(10.0)
    path = JointPath.through([[0.0], [0.1], [0.325], [0.225]], limits, rest_at=(1, 2))
    samples = sample(time_joint_path(path, limits), RATE)
    assert samples.time[-1] == 0.2 + 0.3 + 0.2
    assert np.abs(samples.ddq).max() <= 10.0 * (1.0 + 1e-12)


def test_a_move_that_is_longer_than_whole_periods_takes_one_more() -> None:
    limits = _limits(10.0)
    path = JointPath.through([[0.0], [0.1 * (1.0 + 1e-6)]], limits)
    assert len(sample(time_joint_path(path, limits), RATE).time) == 202


def test_a_limit_of_the_tool_is_not_exceeded_to_end_in_time() -> None:
    limits = _limits(1e3)
    tool = ToolLimits(
        lambda _, dq, ddq: (np.pad(dq, ((0, 0), (0, 5))), np.pad(ddq, ((0, 0), (0, 5)))),
        linear_acceleration=10.0,
    )
    timed = time_joint_path(JointPath.through([[0.0], [0.1]], limits), limits, constraints=[tool])
    samples = sample(timed, RATE)
    assert len(samples.time) == 202  # the limits of the tool are kept with a margin
    assert np.abs(samples.ddq).max() <= 10.0


def _request(**more: Any) -> dict[str, Any]:
    limits = {"acceleration": 10.0, "velocity": 3.0, **more.pop("limits", {})}
    waypoints = [[0.0] * 6, [0.1, 0.0, 0.0, 0.0, 0.0, 0.0]]
    sampling = {"rate_hz": RATE}
    return {
        "robot": "ur5",
        "waypoints": waypoints,
        "limits": limits,
        "sampling": sampling,
        "scene": {"self_collision": False},
        **more,
    }


def test_a_plan_of_whole_periods_takes_them_and_says_what_wider_limits_bring() -> None:
    plan = time_request(_request())
    assert plan.duration == 0.2
    assert plan.timing is not None
    assert plan.timing.grid_factor == 1.0
    assert all(row.duration <= 0.2 for row in plan.timing.what_if)
    assert plan.certificate.valid


def test_a_duration_of_just_what_a_motion_takes_can_be_asked_for() -> None:
    assert time_request(_request(limits={"duration": 0.2})).duration == 0.2
    with pytest.raises(TimingFailed) as error:
        time_request(_request(limits={"duration": 0.1999}))
    nearest: Any = error.value.nearest
    assert nearest["limits"]["duration"] == pytest.approx(0.2, rel=1e-8)
