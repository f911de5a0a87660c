"""Jerk-limited timing, judged by finite differences of the samples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan.errors import InvalidRequest
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.robots import load_robot
from ikplan.timing import (
    TimedPath,
    ToolLimits,
    binding,
    sample,
    time_joint_path,
    what_if,
)
from ikplan.timing.constraints.models import tool_motion

from .cases import (
    CASES,
    DOF,
    assert_keeps_limits,
    assert_meets_waypoints,
    make_limits,
)


def with_jerk(limits: JointLimits, multiple: float) -> JointLimits:
    return JointLimits(
        limits.lower,
        limits.upper,
        limits.velocity,
        limits.acceleration,
        limits.joint_names,
        jerk=limits.acceleration * multiple,
    )


def assert_keeps_jerk(timed: TimedPath, limits: JointLimits) -> None:
    assert limits.jerk is not None
    time = np.arange(0.0, timed.duration, 1e-3)
    _, _, ddq = timed.evaluate(time)
    assert (np.abs(np.diff(ddq, axis=0)) * 1e3 <= limits.jerk * 1.01).all()
    # From rest to rest without a step of the acceleration.
    _, dq, ddq = timed.evaluate([0.0, timed.duration])
    assert np.abs(dq).max() == 0.0
    assert np.abs(ddq).max() == 0.0


@pytest.mark.parametrize(
    ("name", "multiple"), [(n, 8.0) for n in CASES] + [("helix", 2.0), ("line", 50.0)]
)
def test_jerk_and_every_other_limit_are_kept(name: str, multiple: float) -> None:
    limits = with_jerk(make_limits(DOF), multiple)
    waypoints = CASES[name][:60]
    timed = time_joint_path(JointPath.through(waypoints, limits), limits)
    assert timed.jerk_limited
    assert_keeps_limits(timed, limits)
    assert_keeps_jerk(timed, limits)
    assert_meets_waypoints(timed, waypoints)


@settings(max_examples=10, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    dof=st.integers(1, 7),
    count=st.integers(2, 12),
    scale=st.sampled_from([1e-6, 0.1, 2.9]),
)
def test_random_paths_keep_their_jerk_limits(seed: int, dof: int, count: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    limits = with_jerk(make_limits(dof, seed=seed % 5), 10.0 ** rng.uniform(0.5, 2.0))
    path = JointPath.through(rng.uniform(-scale, scale, (count, dof)), limits)
    timed = time_joint_path(path, limits)
    assert_keeps_limits(timed, limits)
    assert_keeps_jerk(timed, limits)


def test_without_a_jerk_limit_the_motion_says_that_it_is_not_limited() -> None:
    limits = make_limits(DOF)
    assert not time_joint_path(JointPath.through(CASES["helix"], limits), limits).jerk_limited


def test_the_price_of_a_jerk_limit_is_told_and_grows_as_it_tightens() -> None:
    limits = make_limits(DOF)
    path = JointPath.through(CASES["helix"], limits)
    free = time_joint_path(path, limits).duration
    durations = []
    for multiple in (1000.0, 30.0, 5.0):
        timed = time_joint_path(path, with_jerk(limits, multiple))
        assert timed.unlimited_duration == pytest.approx(min(free, timed.duration), rel=1e-9)
        durations.append(timed.duration)
    # The free motion is on a coarser grid, which may cost it 0.3 %.
    assert 0.997 * free < durations[0] < durations[1] < durations[2]
    assert durations[0] < 1.002 * free


def test_the_geometric_path_is_kept_exactly() -> None:
    limits = make_limits(DOF)
    path = JointPath.through(CASES["random"], limits)
    timed = time_joint_path(path, with_jerk(limits, 10.0))
    q, dq, _ = timed.evaluate(np.linspace(0, timed.duration, 60))
    fine = path(np.linspace(0, path.length, 200_001))
    for row, speed in zip(q, dq, strict=True):
        nearest = fine[np.argmin(np.linalg.norm(fine - row, axis=1))]
        # Off the nearest point only along the path.
        off = row - nearest
        along = speed / max(np.linalg.norm(speed), 1e-12)
        assert np.linalg.norm(off - along * (off @ along)) < 1e-6


@pytest.mark.parametrize("distance", [1e-6, 0.01, 0.5, 2.0])
def test_a_short_move_is_near_the_closed_form_of_the_jerk_limit(distance: float) -> None:
    # Too short to reach any other limit: four phases of full jerk, (32 d / j)^(1/3).
    limits = JointLimits([-9], [9], [9.0], [900.0], ("j",), jerk=[50.0])  # type: ignore[arg-type]
    timed = time_joint_path(JointPath.through([[0.0], [distance]], limits), limits)
    best = np.cbrt(32.0 * distance / 50.0)
    assert best <= timed.duration <= (1.0 + 1e-7) * best


def test_a_bent_spline_stops_where_its_curvature_steps() -> None:
    limits = with_jerk(make_limits(2), 10.0)
    waypoints = [[0.0, 0.0], [3.0, 1.0], [3.0, -1.0], [0.0, 0.0]]
    path = JointPath.through(waypoints, limits)
    assert len(path.curvature_jumps()) > 0
    timed = time_joint_path(path, limits)
    at = timed.path.s_knots[list(timed.path.rest_knots)]
    assert set(path.s_knots[path.curvature_jumps()]) <= set(at)
    assert_keeps_jerk(timed, limits)
    assert_keeps_limits(timed, limits)


@pytest.mark.parametrize("name", ["helix", "line", "duplicates", "there and back"])
def test_a_path_with_continuous_curvature_is_not_stopped_on_its_way(name: str) -> None:
    limits = with_jerk(make_limits(DOF), 10.0)
    timed = time_joint_path(JointPath.through(CASES[name], limits), limits)
    assert len(timed.path.rest_knots) == 2


def test_tool_limits_hold_in_a_jerk_limited_motion() -> None:
    robot = load_robot("ur5")
    limits = JointLimits.from_robot(robot, jerk=10.0 * robot.acceleration_limit)
    rng = np.random.default_rng(4)
    q = robot.home + np.cumsum(rng.normal(0, 0.15, (6, robot.dof)), axis=0)
    tool = ToolLimits(tool_motion(robot), linear_speed=0.2)
    timed = time_joint_path(JointPath.through(q, limits), limits, constraints=[tool])
    samples = sample(timed, 1000.0)
    twist, _ = tool_motion(robot)(samples.q, samples.dq, samples.ddq)
    assert np.linalg.norm(twist[:, :3], axis=1).max() <= 0.2
    assert_keeps_jerk(timed, limits)


@pytest.mark.parametrize("jerk", [[1.0], [1.0, 0.0], [1.0, np.nan], [1.0, np.inf]])
def test_jerk_limits_that_make_no_sense_are_refused(jerk: list[float]) -> None:
    with pytest.raises(InvalidRequest, match="jerk"):
        JointLimits([-1, -1], [1, 1], [1, 1], [1, 1], ("a", "b"), jerk=jerk)  # type: ignore[arg-type]


def test_a_jerk_limit_can_bind_and_what_more_of_it_brings_is_computed() -> None:
    limits = JointLimits([-9], [9], [9.0], [900.0], ("j",), jerk=[50.0])  # type: ignore[arg-type]
    timed = time_joint_path(JointPath.through([[0.0], [0.5]], limits), limits)
    first = binding(timed).summary()[0]
    assert (first.limit, first.joint) == ("jerk", "j")
    assert first.share > 0.9
    # Four phases of full jerk: the duration goes with the cube root of the limit.
    more = what_if(timed, "jerk", "j", 1.1)
    assert more.duration == pytest.approx(timed.duration / np.cbrt(1.1), rel=1e-3)
    assert what_if(timed, "velocity", "j", 1.1).saved == pytest.approx(0.0, abs=1e-9)
