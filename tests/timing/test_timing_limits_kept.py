"""The promises of a timing: no limit exceeded at 10 kHz, waypoints met, rest at both ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import on_grid, sample, time_joint_path

from .cases import CASES, DOF, assert_keeps_limits, assert_meets_waypoints, make_limits


@pytest.mark.parametrize("name", CASES)
def test_no_limit_is_exceeded_and_every_waypoint_is_met(name: str) -> None:
    waypoints, limits = CASES[name], make_limits(DOF)
    timed = time_joint_path(JointPath.through(waypoints, limits), limits)
    assert_keeps_limits(timed, limits)
    assert_meets_waypoints(timed, waypoints)
    assert (np.diff(timed.node_times) > 0.0).all()


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    dof=st.integers(1, 8),
    count=st.integers(1, 40),
    scale=st.sampled_from([1e-9, 1e-4, 0.1, 3.0]),
    repeat=st.booleans(),
)
def test_random_paths_keep_their_limits(
    seed: int, dof: int, count: int, scale: float, repeat: bool
) -> None:
    rng = np.random.default_rng(seed)
    waypoints = rng.uniform(-scale, scale, (count, dof))
    if repeat:
        waypoints = np.repeat(waypoints, rng.integers(1, 3, count), axis=0)
    limits = make_limits(dof, seed=seed % 7)
    timed = time_joint_path(JointPath.through(waypoints, limits), limits)
    assert_keeps_limits(timed, limits)
    assert_meets_waypoints(timed, waypoints)


@pytest.mark.parametrize(("velocity", "acceleration"), [(1.0, 10.0), (10.0, 1.0), (0.3, 0.2)])
@pytest.mark.parametrize("distance", [1e-9, 1e-3, 1.0, 50.0])
def test_a_single_joint_moves_with_the_closed_form_trapezoid(
    velocity: float, acceleration: float, distance: float
) -> None:
    limits = JointLimits([-np.inf], [np.inf], [velocity], [acceleration], ("j",))  # type: ignore[arg-type]
    timed = time_joint_path(JointPath.through([[0.0], [distance]], limits), limits)
    ramp = velocity**2 / acceleration
    if distance <= ramp:
        best = 2.0 * np.sqrt(distance / acceleration)
    else:
        best = 2.0 * velocity / acceleration + (distance - ramp) / velocity
    assert best <= timed.duration * (1 + 1e-12)
    assert timed.duration <= best * 1.003


def test_waypoints_that_coincide_have_the_same_time() -> None:
    waypoints = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.5], [1.0, 0.5], [2.0, 0.0], [2.0, 0.0]])
    limits = make_limits(2)
    times = time_joint_path(JointPath.through(waypoints, limits), limits).times
    assert times[0] == times[1] == 0.0
    assert times[2] == times[3]
    assert times[4] == times[5]
    assert times[0] < times[2] < times[4]


@pytest.mark.parametrize("rate_hz", [1.0, 30.0, 250.0, 1000.0, 10_000.0])
@pytest.mark.parametrize("name", ["helix", "motion of 1e-9", "one waypoint", "there and back"])
def test_samples_are_strictly_increasing_and_end_exactly(name: str, rate_hz: float) -> None:
    waypoints, limits = CASES[name], make_limits(DOF)
    timed = time_joint_path(JointPath.through(waypoints, limits), limits)
    samples = sample(timed, rate_hz)
    assert np.array_equal(samples.time, np.arange(len(samples.time)) / rate_hz)
    assert np.array_equal(samples.q[0], waypoints[0])
    assert np.array_equal(samples.q[-1], waypoints[-1])
    assert (samples.dq[[0, -1]] == 0.0).all()
    # The least whole number of periods that the motion fits into.
    assert 0.0 <= samples.time[-1] * rate_hz - timed.duration * rate_hz < 1.0
    assert samples.time[-1] == on_grid(timed, rate_hz).duration


@pytest.mark.parametrize("rate_hz", [125.0, 333.3, 1000.0])
@pytest.mark.parametrize("jerk", [None, 200.0])
def test_a_motion_on_the_grid_is_the_same_motion_slower(rate_hz: float, jerk: float | None) -> None:
    limits = make_limits(DOF)
    if jerk is not None:
        limits = replace(limits, jerk=np.full(DOF, jerk))
    timed = time_joint_path(JointPath.through(CASES["helix"], limits), limits)
    slower = on_grid(timed, rate_hz)
    factor = slower.duration / timed.duration
    assert 1.0 <= factor < 1.0 + 1.0 / (rate_hz * timed.duration)
    assert slower.duration * rate_hz == pytest.approx(round(slower.duration * rate_hz), abs=1e-9)
    time = np.linspace(0.0, timed.duration, 501)[1:-1]
    for power, (mine, theirs) in enumerate(
        zip(slower.evaluate(time * factor), timed.evaluate(time), strict=True)
    ):
        np.testing.assert_allclose(mine * factor**power, theirs, rtol=1e-9, atol=1e-7)
    again = on_grid(slower, rate_hz)
    assert again.duration == slower.duration
    assert np.array_equal(again.node_times, slower.node_times)


@pytest.mark.parametrize("rate_hz", [0.0, -1.0, 10_001.0, np.nan, np.inf])
def test_a_rate_out_of_range_is_refused(rate_hz: float) -> None:
    limits = make_limits(2)
    timed = time_joint_path(JointPath.through([[0.0, 0.0], [1.0, 1.0]], limits), limits)
    with pytest.raises(InvalidRequest) as error:
        sample(timed, rate_hz)
    assert error.value.field == "sampling.rate_hz"


def test_a_path_made_without_limits_that_leaves_them_is_refused_by_joint() -> None:
    limits = make_limits(2, box=1.0)
    path = JointPath.through([[0.0, 0.0], [0.0, 0.99], [0.5, 0.99], [0.5, 0.0]])
    assert path.extrema()[1][1] > 1.0
    with pytest.raises(TimingFailed) as error:
        time_joint_path(path, limits)
    assert (error.value.limit, error.value.joint) == ("position", "joint1")


def test_the_same_path_is_timed_the_same_bit_for_bit() -> None:
    limits = make_limits(DOF)
    runs = [time_joint_path(JointPath.through(CASES["random"], limits), limits) for _ in range(2)]
    assert np.array_equal(runs[0].node_times, runs[1].node_times)
    assert np.array_equal(runs[0].sdot, runs[1].sdot)
