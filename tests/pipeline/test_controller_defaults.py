"""What a request leaves unsaid, the robot's controller decides; and the plan says so."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

import ikplan
from benchmarks.programs.fci import FER, FR3, FciLimits, judge
from benchmarks.programs.plans import random_plans
from ikplan import InvalidRequest, PlanRequest, load_robot
from ikplan.plans.plan import Plan

from .paths import on, pose


def moved(name: str, **fields: Any) -> dict[str, Any]:
    """A short way of a robot's tool from its home."""
    robot = load_robot(name)
    step = np.full(robot.dof, 0.15) * (-1.0) ** np.arange(robot.dof)
    return on(name, pose(robot.fk(robot.home + step)), ik={"method": "lm"}, **fields)


@pytest.mark.parametrize(
    ("name", "rate_hz", "source"),
    [("ur5", 125.0, "controller"), ("ur5e", 500.0, "controller"), ("panda", 1000.0, "controller"),
     ("iiwa14", 250.0, "default")],
)  # fmt: skip
def test_a_request_without_a_rate_has_the_controllers(
    name: str, rate_hz: float, source: str
) -> None:
    for request in (moved(name), moved(name, sampling={"rate_hz": None})):
        plan = ikplan.plan(request)
        assert plan.timing is not None
        assert (plan.timing.rate_hz, plan.timing.rate_source) == (rate_hz, source)
        assert np.array_equal(plan.time, np.arange(len(plan.time)) / rate_hz)
        assert plan.timing.duration == plan.duration == plan.waypoints.time[-1]
    asked = ikplan.plan(moved(name, sampling={"rate_hz": 99.0}))
    assert asked.timing is not None
    assert (asked.timing.rate_hz, asked.timing.rate_source) == (99.0, "request")
    assert np.array_equal(asked.time, np.arange(len(asked.time)) / 99.0)


def test_what_is_null_stays_null_in_the_canonical_request() -> None:
    request = PlanRequest(**moved("panda"))
    assert request.sampling.rate_hz is None
    assert request.limits.jerk is None
    explicit = PlanRequest(**moved("panda", sampling={"rate_hz": 1000.0}))
    assert request.content_hash() != explicit.content_hash()
    assert np.array_equal(ikplan.plan(request).q, ikplan.plan(explicit).q)


def test_the_makers_jerk_holds_unless_the_request_says_otherwise() -> None:
    robot = load_robot("panda")
    by_default = ikplan.plan(moved("panda"))
    free = ikplan.plan(moved("panda", limits={"jerk": False}))
    mild = ikplan.plan(moved("panda", limits={"jerk": 300.0}))
    wild = ikplan.plan(moved("panda", limits={"jerk": 1e9}))
    sources = [plan.timing.jerk_source for plan in (by_default, free, mild, wild) if plan.timing]
    assert sources == ["controller", None, "request", "request"]
    assert [plan.certificate.jerk_limited for plan in (by_default, free)] == [True, False]
    assert free.duration < by_default.duration < mild.duration
    # A wider limit than the maker's does not widen it.
    assert np.array_equal(wild.q, by_default.q)
    assert robot.jerk_limit is not None
    jerk = np.abs(np.diff(by_default.ddq, axis=0)) * 1000.0
    assert (jerk <= robot.jerk_limit).all()
    for plan, zero in ((by_default, True), (free, False), (mild, True)):
        assert plan.timing is not None
        assert plan.timing.zero_end_acceleration == zero
        assert (not plan.ddq[[0, -1]].any()) == zero
    # Where no maker publishes one, there is none.
    assert not ikplan.plan(moved("ur5e")).certificate.jerk_limited


@pytest.mark.parametrize("value", [True, "none", 0, -1.0, [1.0, 2.0]])
def test_a_jerk_limit_of_another_kind_is_refused(value: Any) -> None:
    with pytest.raises(InvalidRequest, match=r"limits\.jerk"):
        ikplan.plan(moved("panda", limits={"jerk": value}))
    segment = {"type": "line", "to": {"position": [0.5, 0.0, 0.5]}, "limits": {"jerk": False}}
    with pytest.raises(InvalidRequest, match=r"segments\[0\]\.limits\.jerk"):
        ikplan.plan({"robot": "panda", "path": {"segments": [segment]}})


def test_a_plan_carries_its_controller_and_reads_back() -> None:
    plan = ikplan.plan(moved("ur5"))
    robot = load_robot("ur5")
    assert robot.controller is not None
    assert plan.controller == robot.controller.info()
    assert Plan.load(plan.model_dump_json()).controller == plan.controller
    assert ikplan.plan(moved("iiwa14")).controller is None


def test_a_timing_has_the_same_defaults() -> None:
    robot = load_robot("panda")
    way = [robot.home, robot.home + 0.2]
    plan = ikplan.time_path(robot, way)
    assert plan.timing is not None
    assert (plan.timing.rate_hz, plan.timing.jerk_source) == (1000.0, "controller")
    free = ikplan.time_path(robot, way, limits={"jerk": False}, rate_hz=250)
    assert free.timing is not None
    assert (free.timing.rate_hz, free.timing.jerk_source) == (250.0, None)
    assert free.duration < plan.duration


def test_a_shorter_motion_than_a_period_takes_one_and_one_of_no_length_none() -> None:
    robot = load_robot("ur5")
    tiny = ikplan.time_path(robot, [robot.home, robot.home + 1e-9])
    assert tiny.time.tolist() == [0.0, 0.008]
    assert ikplan.time_path(robot, [robot.home]).time.tolist() == [0.0]


def test_a_motion_too_long_for_the_cycle_is_refused_with_a_rate_that_would_do() -> None:
    robot = load_robot("panda")
    slow = {"velocity_scale": 1e-3}
    with pytest.raises(InvalidRequest, match="a rate of at most"):
        ikplan.time_path(robot, [robot.home, robot.home + 0.6], limits=slow)


@pytest.mark.parametrize(("name", "limits"), [("panda", FER), ("fr3", FR3)])
def test_franka_arms_never_see_a_limit_exceeded_at_1_khz(name: str, limits: FciLimits) -> None:
    for plan in itertools.islice(random_plans((name,), seed=4), 2):
        found = judge(plan.time, plan.q, plan.ddq, limits)
        assert found.over == 0
        assert found.end_acceleration == 0.0
        assert max(found.velocity, found.acceleration, found.jerk) > 0.5


def test_the_fci_judge_finds_a_plan_without_jerk_limits_wanting() -> None:
    plan = ikplan.plan(moved("panda", limits={"jerk": False}))
    found = judge(plan.time, plan.q, plan.ddq, FER)
    assert found.over > 0
    assert found.end_acceleration > 1.0
