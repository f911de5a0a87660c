"""Limits of ranges, of the tool and of torques, judged by Pinocchio on the samples."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.robots import Robot, load_robot
from ikplan.timing import (
    SegmentJointLimits,
    ToolLimits,
    TorqueLimits,
    sample,
    time_joint_path,
)
from ikplan.timing.constraints.models import inverse_dynamics, tool_motion
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.rows import StageRows


@functools.cache
def robot(name: str) -> Robot:
    return load_robot(name)


def waypoints(name: str, seed: int = 0) -> np.ndarray:
    arm = robot(name)
    rng = np.random.default_rng(seed)
    return arm.home + np.cumsum(rng.normal(0, 0.2, (8, arm.dof)), axis=0)


def setup(name: str, seed: int = 0) -> tuple[JointPath, JointLimits]:
    limits = JointLimits.from_robot(robot(name))
    q = np.clip(waypoints(name, seed), limits.lower, limits.upper)
    return JointPath.through(q, limits), limits


def tool_speeds(name: str, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
    arm = robot(name)
    return np.array([arm.jacobian(a) @ b for a, b in zip(q, dq, strict=True)])


@pytest.mark.parametrize("name", ["panda", "ur5", "kinova_j2s6s200", "dobot_magician"])
def test_tool_motion_is_the_derivative_of_the_tool_pose(name: str) -> None:
    arm = robot(name).with_tool([0.05, -0.02, 0.1])
    rng = np.random.default_rng(3)
    q = np.clip(arm.home + rng.normal(0, 0.1, arm.dof), arm.lower, arm.upper)
    dq, ddq = rng.normal(size=(2, arm.dof))
    motion = tool_motion(arm)
    v, a = motion(q[None], dq[None], ddq[None])
    local = arm.jacobian(q) @ dq
    assert np.linalg.norm(v[0, :3]) == pytest.approx(np.linalg.norm(local[:3]), rel=1e-9)
    assert np.linalg.norm(v[0, 3:]) == pytest.approx(np.linalg.norm(local[3:]), rel=1e-9)
    h = 1e-5
    after = motion((q + h * dq + h * h / 2 * ddq)[None], (dq + h * ddq)[None], ddq[None])[0]
    before = motion((q - h * dq + h * h / 2 * ddq)[None], (dq - h * ddq)[None], ddq[None])[0]
    assert np.abs((after - before) / (2 * h) - a).max() < 1e-6 * max(1.0, np.abs(a).max())


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_tool_speed_limits_hold_on_the_samples(name: str) -> None:
    path, limits = setup(name)
    free = time_joint_path(path, limits)
    tool = ToolLimits(tool_motion(robot(name)), linear_speed=0.25, angular_speed=0.6)
    slow = time_joint_path(path, limits, constraints=[tool])
    samples = sample(slow, 1000.0)
    twist = tool_speeds(name, samples.q, samples.dq)
    linear, angular = (np.linalg.norm(part, axis=1) for part in (twist[:, :3], twist[:, 3:]))
    assert linear.max() <= 0.25
    assert angular.max() <= 0.6
    assert slow.duration > free.duration
    # The limit is used, not only kept: one of the two binds nearly all the time.
    assert np.mean(np.maximum(linear / 0.25, angular / 0.6) > 0.97) > 0.7


@pytest.mark.parametrize("name", ["panda", "kinova_j2s6s200", "dobot_magician"])
def test_tool_acceleration_limits_hold_on_the_samples(name: str) -> None:
    path, limits = setup(name)
    motion = tool_motion(robot(name))
    tool = ToolLimits(motion, linear_acceleration=1.0, angular_acceleration=2.0)
    timed = time_joint_path(path, limits, constraints=[tool])
    samples = sample(timed, 1000.0)
    _, a = motion(samples.q, samples.dq, samples.ddq)
    linear, angular = np.linalg.norm(a[:, :3], axis=1), np.linalg.norm(a[:, 3:], axis=1)
    assert linear.max() <= 1.0
    assert angular.max() <= 2.0
    # Some limit binds nearly all the time.
    joints = np.maximum(
        np.abs(samples.dq) / limits.velocity, np.sqrt(np.abs(samples.ddq) / limits.acceleration)
    ).max(axis=1)
    assert np.mean(np.maximum(np.maximum(linear, angular / 2.0), joints) > 0.98) > 0.9


def test_the_compiled_engine_keeps_rows_that_hardly_depend_on_the_acceleration() -> None:
    # A disc by its tangents: cos(pi / 2) is 6e-17, and where that row binds, (1 - b x) / a is
    # rounding over nothing.
    s = np.linspace(0.0, 1.0, 200)
    angle = 2.0 * np.pi * np.arange(24) / 24
    here = s[:-1]
    a = np.outer(0.3 + 0.15 * np.cos(20.0 * here), np.cos(angle))
    b = np.outer(10.0 * np.sin(7.0 * here), np.cos(angle))
    b += np.outer(5.0 + 4.0 * np.sin(9.0 * here), np.sin(angle))
    x = CompiledEngine().solve(StageRows(s, a, b, np.full(200, 1e8)))
    u = np.diff(x) / (2.0 * np.diff(s))
    used = (a * u[:, None] + b * x[:-1, None]).max(axis=1)
    assert used.max() <= 1.0 + 1e-9
    assert np.mean(used > 0.999) > 0.95


def test_a_tool_limit_of_a_range_holds_there_and_only_there() -> None:
    path, limits = setup("ur5")
    start, end = 0.3 * path.length, 0.6 * path.length
    tool = ToolLimits(tool_motion(robot("ur5")), linear_speed=0.05, start=start, end=end)
    timed = time_joint_path(path, limits, constraints=[tool])
    samples = sample(timed, 1000.0)
    speed = np.linalg.norm(tool_speeds("ur5", samples.q, samples.dq)[:, :3], axis=1)
    s = np.interp(samples.time, timed.node_times, timed.s)
    inside = (s > start) & (s < end)
    assert speed[inside].max() <= 0.05
    assert speed[~inside].max() > 0.2


def test_a_straight_tool_line_runs_at_constant_speed() -> None:
    # Two prismatic joints are a Cartesian table: the tool is where the joints are.
    limits = JointLimits([-9, -9], [9, 9], [5, 5], [50, 50], ("x", "y"))  # type: ignore[arg-type]

    def motion(_: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        pad = ((0, 0), (0, 4))
        return np.pad(dq, pad), np.pad(ddq, pad)

    path = JointPath.through(np.linspace([0.0, 0.0], [3.0, 4.0], 9), limits)
    tool = ToolLimits(motion, linear_speed=1.0)
    timed = time_joint_path(path, limits, constraints=[tool])
    time = np.linspace(0.05 * timed.duration, 0.95 * timed.duration, 500)
    speed = np.linalg.norm(timed.evaluate(time)[1], axis=1)
    assert np.ptp(speed) < 1e-6
    assert speed.max() == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_torques_of_the_samples_are_within_limits(name: str) -> None:
    arm = robot(name)
    path, limits = setup(name, seed=1)
    dynamics = inverse_dynamics(arm)
    still = np.zeros((200, arm.dof))
    q = path(np.linspace(0, path.length, 200))
    gravity = np.abs(dynamics(q, still, still)).max(axis=0)
    # Little more than standing needs, so that torque binds and not acceleration.
    effort = gravity * 1.05 + 2.0
    timed = time_joint_path(
        path, limits, constraints=[TorqueLimits(dynamics, effort, arm.joint_names)]
    )
    samples = sample(timed, 1000.0)
    data = arm.model.createData()
    tau = np.array(
        [
            pin.rnea(arm.model, data, arm.configuration(a), b, c)
            for a, b, c in zip(samples.q, samples.dq, samples.ddq, strict=True)
        ]
    )
    assert (np.abs(tau) <= effort).all()
    assert np.mean((np.abs(tau) / effort).max(axis=1) > 0.98) > 0.3
    assert timed.duration > time_joint_path(path, limits).duration


@pytest.mark.parametrize("name", [n for n in REFERENCE_ROBOTS if robot(n).info().inertias_sourced])
def test_torques_are_those_of_pinocchio(name: str) -> None:
    arm = robot(name).with_tool([0.05, -0.02, 0.1])
    load = pin.Inertia(1.3, np.array([0.01, 0.02, 0.03]), np.zeros((3, 3)))
    model = arm.model.copy()
    tip = model.frames[arm.tip_frame_id]
    model.appendBodyToJoint(tip.parentJoint, load, tip.placement * arm.T_tip_tool)
    data = model.createData()
    rng = np.random.default_rng(5)
    q = np.array([arm.random_configuration(rng) for _ in range(20)])
    dq, ddq = rng.normal(size=q.shape), 5.0 * rng.normal(size=q.shape)
    motions = zip(arm.configurations(q), dq @ arm.coupling.T, ddq @ arm.coupling.T, strict=True)
    expected = np.array([pin.rnea(model, data, *motion) for motion in motions]) @ arm.coupling
    torques = inverse_dynamics(arm, load)(q, dq, ddq)
    assert np.abs(torques - expected).max() <= 1e-12 * np.abs(expected).max()


def test_a_payload_needs_more_torque() -> None:
    arm = robot("panda")
    q = arm.home[None]
    zero = np.zeros_like(q)
    load = pin.Inertia(2.0, np.zeros(3), np.zeros((3, 3)))
    bare = inverse_dynamics(arm)(q, zero, zero)
    loaded = inverse_dynamics(arm, load)(q, zero, zero)
    # Virtual work of the weight: tau = J^T F, with F up at the tool.
    T = arm.fk(arm.home)
    lift = arm.jacobian(arm.home)[:3].T @ T.rotation.T @ np.array([0.0, 0.0, 2.0 * 9.81])
    assert np.abs(loaded - bare - lift).max() < 1e-6


def test_a_torque_limit_below_gravity_is_refused_by_joint_and_place() -> None:
    arm = robot("panda")
    path, limits = setup("panda")
    effort = np.full(7, 200.0)
    effort[1] = 1.0
    weak = TorqueLimits(inverse_dynamics(arm), effort, arm.joint_names)
    with pytest.raises(TimingFailed) as error:
        time_joint_path(path, limits, constraints=[weak])
    assert (error.value.joint, error.value.limit) == (arm.joint_names[1], "torque")
    assert error.value.position is not None
    assert 0.0 <= error.value.position <= 1.0


def test_torque_limits_of_a_robot_without_inertias_are_refused() -> None:
    with pytest.raises(InvalidRequest, match="inertias"):
        inverse_dynamics(robot("mh5"))


def test_the_strictest_of_overlapping_ranges_holds() -> None:
    path, limits = setup("panda")
    names = limits.joint_names
    box = (limits.lower, limits.upper)
    half = JointLimits(*box, limits.velocity * 0.5, limits.acceleration * 0.5, names)
    odd = JointLimits(*box, limits.velocity * 2.0, limits.acceleration * 0.2, names)
    a, b, c = (share * path.length for share in (0.2, 0.5, 0.8))
    timed = time_joint_path(
        path, limits, segments=[SegmentJointLimits(a, c, half), SegmentJointLimits(b, c, odd)]
    )
    samples = sample(timed, 2000.0)
    s = np.interp(samples.time, timed.node_times, timed.s)
    speed = np.abs(samples.dq) / limits.velocity
    pull = np.abs(samples.ddq) / limits.acceleration
    # Whole intervals only: s of a sample is interpolated, not exact at the border.
    slack = 0.01 * path.length
    assert speed[(s > a + slack) & (s < c - slack)].max() <= 0.5
    assert pull[(s > a + slack) & (s < b - slack)].max() <= 0.5
    assert pull[(s > b + slack) & (s < c - slack)].max() <= 0.2
    assert pull[s < a - slack].max() > 0.9
    assert (speed.max(), pull.max()) <= (1.0, 1.0)


@pytest.mark.parametrize("rest_at", [(), (3,)])
def test_knots_for_ranges_leave_the_path_as_it_is(rest_at: tuple[int, ...]) -> None:
    limits = JointLimits.from_robot(robot("ur5"))
    path = JointPath.through(waypoints("ur5"), limits, rest_at=rest_at)
    divided = path.with_knots([0.1, 0.11, path.length / 3, path.s_knots[2], -1.0, 1e9])
    s = np.linspace(0.0, path.length, 400)
    for before, after in zip(path.derivatives(s), divided.derivatives(s), strict=True):
        assert np.abs(before - after).max() < 1e-8
    assert np.array_equal(divided.s_waypoints, path.s_waypoints)
    assert len(divided.s_knots) == len(path.s_knots) + 3


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ({"linear_speed": 0.0}, "limits.tool.linear_speed"),
        ({"angular_acceleration": -1.0}, "limits.tool.angular_acceleration"),
        ({"angular_speed": np.nan}, "limits.tool.angular_speed"),
        ({}, "limits.tool"),
    ],
)
def test_tool_limits_that_make_no_sense_are_refused(values: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidRequest) as error:
        ToolLimits(tool_motion(robot("ur5")), **values)
    assert error.value.field == field


@pytest.mark.parametrize(
    ("effort", "field"),
    [([1.0, 2.0], "limits.effort"), ([1, 2, 0.0, 1, 1, 1], "limits.effort[2]")],
)
def test_torque_limits_that_make_no_sense_are_refused(effort: list[float], field: str) -> None:
    arm = robot("ur5")
    with pytest.raises(InvalidRequest) as error:
        TorqueLimits(inverse_dynamics(arm), effort, arm.joint_names)
    assert error.value.field == field
