"""The last look at a motion: a limit that a timing did not see between its points is kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ikplan.errors import BudgetExceeded, TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.planning import TimeBudget
from ikplan.robots import load_robot
from ikplan.timing import (
    PathConstraint,
    TimedPath,
    ToolLimits,
    TorqueLimits,
    sampled_within_limits,
    time_joint_path,
    what_if,
)
from ikplan.timing.constraints.interval_points import bend, highest
from ikplan.timing.constraints.models import inverse_dynamics, tool_motion

ROBOT = load_robot("ur5")


def path_of(seed: int = 0) -> tuple[JointPath, JointLimits]:
    limits = JointLimits.from_robot(ROBOT)
    rng = np.random.default_rng(seed)
    return JointPath.through(ROBOT.home + np.cumsum(rng.normal(0, 0.2, (6, 6)), axis=0)), limits


def tool(**limits: float) -> ToolLimits:
    return ToolLimits(tool_motion(ROBOT), **limits)


def torques() -> TorqueLimits:
    still = np.zeros((100, 6))
    path, _ = path_of()
    dynamics = inverse_dynamics(ROBOT)
    gravity = np.abs(dynamics(path(np.linspace(0, path.length, 100)), still, still)).max(axis=0)
    return TorqueLimits(dynamics, 1.05 * gravity + 1.0, tuple(ROBOT.joint_names))


@pytest.mark.parametrize(
    "constraint",
    [tool(linear_speed=0.2), tool(angular_acceleration=2.0), torques()],
    ids=["speed", "acceleration", "torque"],
)
@pytest.mark.parametrize("jerk", [None, 50.0])
@pytest.mark.parametrize("nodes", [False, True])
def test_a_limit_that_a_timing_has_not_seen_is_kept_by_the_samples(
    constraint: PathConstraint, jerk: float | None, nodes: bool
) -> None:
    path, limits = path_of()
    if jerk is not None:
        limits = replace(limits, jerk=np.full(6, jerk))
    blind = time_joint_path(path, limits)
    kept, samples = sampled_within_limits(blind, 200.0, [constraint], nodes)
    used = constraint.ratio(samples.q, samples.dq, samples.ddq)
    assert 0.95 < used.max() <= 1.0
    assert kept.duration > blind.duration
    # And a motion that keeps it is left alone.
    again, _ = sampled_within_limits(kept, 200.0, [constraint], nodes)
    assert np.array_equal(again.node_times, kept.node_times)
    assert np.array_equal(again.sdot, kept.sdot)


@pytest.mark.parametrize("jerk", [None, 50.0])
def test_a_limit_on_a_range_is_looked_at_there_only(jerk: float | None) -> None:
    path, limits = path_of()
    if jerk is not None:
        limits = replace(limits, jerk=np.full(6, jerk))
    blind = time_joint_path(path, limits)
    slow = tool(linear_speed=0.1)
    time = np.linspace(0.0, blind.duration, 5000)
    used = slow.ratio(*blind.evaluate(time))
    for k in range(len(path.s_waypoints) - 1):
        first, last = path.s_waypoints[[k, k + 1]]
        kept, _ = sampled_within_limits(blind, 1000.0, [replace(slow, start=first, end=last)])
        begin, end = blind.times[[k, k + 1]]
        most = used[(time > begin) & (time < end)].max()
        assert kept.duration == pytest.approx(blind.duration * np.sqrt(most), rel=2e-3)


def test_a_torque_limit_that_rest_breaks_is_refused_and_not_slowed_for_ever() -> None:
    path, limits = path_of()
    weak = replace(torques(), effort=np.full(6, 0.1))
    with pytest.raises(TimingFailed, match="stand still"):
        sampled_within_limits(time_joint_path(path, limits), 100.0, [weak])


def test_a_jerk_limit_that_a_timing_has_not_seen_is_kept_by_the_samples() -> None:
    path, limits = path_of()
    limits = replace(limits, jerk=np.full(6, 50.0))
    timed = time_joint_path(path, limits)
    # As if its nodes had been passed a little sooner.
    assert timed.sddot is not None
    hasty = replace(
        timed,
        node_times=timed.node_times / 1.1,
        sdot=timed.sdot * 1.1,
        sddot=timed.sddot * 1.1**2,
    )
    kept, samples = sampled_within_limits(hasty, 1000.0)
    jerk = np.abs(np.diff(samples.ddq, axis=0)) / np.diff(samples.time)[:, None]
    assert 0.99 * 50.0 < jerk.max() <= 50.0
    assert kept.duration == pytest.approx(timed.duration, rel=5e-3)


def test_samples_at_nodes_are_all_told_apart() -> None:
    path, limits = path_of()
    timed = time_joint_path(path, limits)
    timed, samples = sampled_within_limits(timed, 250.0, [], nodes=True)
    steps = np.diff(samples.time)
    assert steps.min() > 1e-6 / 250.0
    assert steps.max() <= (1.0 + 1e-9) / 250.0
    distance = np.abs(samples.time[:, None] - timed.node_times[None]).min(axis=0)
    assert distance.max() <= 1e-6 / 250.0
    assert samples.time[-1] == timed.duration


def test_five_points_see_the_s_that_three_take_for_a_line() -> None:
    r = np.linspace(0.0, 1.0, 2001)
    curve = 1.0 + 0.1 * r * (r - 0.5) * (r - 1.0)
    three, five = curve[[0, 1000, 2000], None], curve[::500, None]
    assert bend(three)[0] < 1e-15
    assert bend(five)[0] > 4 * 0.0015
    assert highest(three)[0] == pytest.approx(1.0, abs=1e-15)
    assert highest(five)[0] == pytest.approx(curve.max(), abs=2e-4)


@pytest.mark.parametrize("top", [0.1, 0.33, 0.6, 0.93])
def test_the_highest_value_of_a_parabola_is_found_between_points(top: float) -> None:
    for points in (3, 5):
        r = np.linspace(0.0, 1.0, points)
        assert highest(2.0 - np.square(r - top))[()] == pytest.approx(2.0, abs=1e-14)
        # A valley is highest at its rim.
        assert highest(np.square(r - top))[()] == pytest.approx(max(top, 1 - top) ** 2, abs=1e-14)


class Spent:
    """A clock that runs out after some looks at it."""

    def __init__(self, looks: int) -> None:
        self.left, self.clock = looks, TimeBudget(1e-9)

    def __call__(self) -> None:
        self.left -= 1
        if self.left < 0:
            self.clock.check()


def timing(jerk: float | None, check: Spent) -> TimedPath:
    path, limits = path_of()
    limits = limits if jerk is None else replace(limits, jerk=np.full(6, jerk))
    return time_joint_path(path, limits, constraints=[tool(linear_speed=0.2)], check=check)


@pytest.mark.parametrize("jerk", [None, 50.0])
def test_a_timing_ends_when_its_budget_runs_out_and_is_else_the_same(jerk: float | None) -> None:
    for looks in (0, 3, 5):
        with pytest.raises(BudgetExceeded):
            timing(jerk, Spent(looks))
    ample = Spent(10**6)
    timed = timing(jerk, ample)
    assert 10**6 - ample.left > 5
    again = timing(jerk, Spent(10**6))
    assert np.array_equal(timed.node_times, again.node_times)
    with pytest.raises(BudgetExceeded):
        what_if(timed, "tool_linear_speed", None, 1.1, Spent(0))
