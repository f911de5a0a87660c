"""What a motion uses of its limits, against finite differences, power and closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from ikplan import load_robot
from ikplan.certificate.limits import (
    RATIO_SLACK,
    jerk_ratios,
    measured_limits,
    measured_positions,
    tool_acceleration_ratios,
    tool_speed_ratios,
    torque_ratios,
)
from ikplan.documents.limits import LimitOptions
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot
from tests.kinematics.synthetic import Joint, robot_of

ROBOTS = ["panda", "ur5", "tiago", "dobot_magician", "kinova_j2s6s200"]
STEP = 1e-5
"""Of the finite differences [s]."""


def robot_named(name: str) -> Robot:
    return load_robot(name).with_tool([0.05, -0.1, 0.2], [0.5, 0.5, 0.5, 0.5])


def states(robot: Robot, count: int, seed: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    q = np.array([0.8 * robot.random_configuration(rng) for _ in range(count)])
    return q, rng.normal(size=q.shape), rng.normal(size=q.shape)


def moved(q: np.ndarray, dq: np.ndarray, ddq: np.ndarray, t: float) -> np.ndarray:
    return q + t * dq + 0.5 * t * t * ddq


def test_a_jerk_is_the_mean_from_a_sample_to_the_next() -> None:
    time = np.array([0.0, 0.5, 0.75, 2.75])
    ddq = np.array([[0.0, 4.0], [1.0, 4.0], [-1.0, 3.0], [3.0, -5.0]])
    expected = [[2.0 / 4, 0.0], [8.0 / 4, 4.0 / 16], [2.0 / 4, 4.0 / 16], [0.0, 0.0]]
    np.testing.assert_allclose(jerk_ratios(time, ddq, np.array([4.0, 16.0])), expected, rtol=1e-15)


def payload_energy(robot: Robot, q: np.ndarray, dq: np.ndarray, mass: float, at: np.ndarray) -> Any:
    """Kinetic and potential energy of the arm and of a point that its tool carries [J]."""
    model = robot.model
    data, serial = model.createData(), robot.coupling @ dq
    own = pin.computeKineticEnergy(model, data, robot.configuration(q), serial)
    own += pin.computePotentialEnergy(model, data, robot.configuration(q))
    place = [(robot.T_universe_base * robot.fk(q + t * dq)).act(at) for t in (-STEP, 0.0, STEP)]
    speed = (place[2] - place[0]) / (2.0 * STEP)
    return own + mass * (0.5 * speed @ speed - model.gravity.linear @ place[1])


@pytest.mark.parametrize("mass", [0.0, 0.5, 4.0])
@pytest.mark.parametrize("name", ROBOTS)
def test_the_power_of_the_torques_is_the_change_of_energy(name: str, mass: float) -> None:
    robot, at = robot_named(name), np.array([0.1, 0.2, -0.3])
    q, _, ddq = states(robot, robot.dof)
    dq = np.diag(np.linspace(0.5, 1.5, robot.dof))  # one joint moves at a time
    limit = np.linspace(1.0, 3.0, robot.dof)
    ratios = torque_ratios(robot, q, dq, ddq, limit, mass, at)
    assert ratios.shape == q.shape
    h = 1e-4
    for k in range(robot.dof):
        before, after = (
            payload_energy(robot, moved(q[k], dq[k], ddq[k], t), dq[k] + t * ddq[k], mass, at)
            for t in (-h, h)
        )
        power = (after - before) / (2.0 * h)
        assert ratios[k, k] * limit[k] * dq[k, k] == pytest.approx(abs(power), rel=1e-4, abs=1e-3)


def test_measuring_torques_leaves_the_robot_as_it_is() -> None:
    robot = robot_named("panda")
    q, dq, ddq = states(robot, 3)
    limit = np.ones(7)
    before = torque_ratios(robot, q, dq, ddq, limit, 0.0, np.zeros(3))
    loaded = torque_ratios(robot, q, dq, ddq, limit, 5.0, np.zeros(3))
    again = torque_ratios(robot, q, dq, ddq, limit, 0.0, np.zeros(3))
    np.testing.assert_array_equal(before, again)
    assert np.abs(loaded - before).max() > 1.0


INF = np.inf


@pytest.mark.parametrize("limit", [(0.5, 2.0), (0.5, INF), (INF, 2.0), (1e-3, 2.0), (0.5, 1e-3)])
@pytest.mark.parametrize("name", ROBOTS)
def test_tool_rates_are_those_of_finite_differences(name: str, limit: tuple[float, float]) -> None:
    robot = robot_named(name)
    q, dq, ddq = states(robot, 6)
    speed = tool_speed_ratios(robot, q, dq, limit)
    rate = tool_acceleration_ratios(robot, q, dq, ddq, limit)
    assert speed.shape == rate.shape == (6,)
    h = 1e-4
    for k in range(6):
        T = [robot.fk(moved(q[k], dq[k], ddq[k], t)) for t in (-h, 0.0, h)]
        p = [t.translation for t in T]
        linear = np.linalg.norm(p[2] - p[0]) / (2.0 * h)
        turns = [pin.log3(a.rotation.T @ b.rotation) for a, b in ((T[0], T[1]), (T[1], T[2]))]
        angular = np.linalg.norm(turns[0] + turns[1]) / (2.0 * h)
        expected = max(linear / limit[0], angular / limit[1])
        assert speed[k] == pytest.approx(expected, rel=1e-5)
        bend = np.linalg.norm(p[2] - 2.0 * p[1] + p[0]) / h**2
        # In the axes of the tool between the two turns, which are those of its middle pose.
        turning = np.linalg.norm(turns[1] - turns[0]) / h**2
        assert rate[k] == pytest.approx(max(bend / limit[0], turning / limit[1]), rel=1e-3)


def test_a_tool_rate_is_that_of_the_tool_and_not_of_the_tip() -> None:
    robot = load_robot("ur5").with_tool([0.0, 0.0, 2.0])
    q, dq = np.zeros((1, 6)), np.zeros((1, 6))
    dq[0, 4] = 1.0  # the fifth axis is across the tool
    place = [robot.fk(q[0] + t * dq[0]).translation for t in (-STEP, STEP)]
    linear = np.linalg.norm(place[1] - place[0]) / (2.0 * STEP)
    assert linear > 2.0
    assert tool_speed_ratios(robot, q, dq, (1.0, INF))[0] == pytest.approx(linear, rel=1e-6)
    turning = tool_acceleration_ratios(robot, q, dq, np.zeros((1, 6)), (1.0, INF))
    assert turning[0] == pytest.approx(linear, rel=1e-6)  # v^2 / r, at 1 rad/s


TIME = np.array([0.0, 0.1, 0.2, 0.3])
PLAIN = MotionLimits.of(load_robot("panda"), LimitOptions(jerk=False))


def motion() -> tuple[Robot, np.ndarray, np.ndarray, np.ndarray]:
    """Samples within the limits of the joints."""
    robot = load_robot("panda")
    q, dq, ddq = states(robot, 4)
    return robot, q, 0.1 * dq, ddq


ALWAYS = {
    "jerk_limited",
    "velocity_limit_ratio",
    "velocity_limit_at",
    "acceleration_limit_ratio",
    "acceleration_limit_at",
}
"""What is measured of every motion."""


def test_what_is_not_limited_is_not_measured() -> None:
    robot, q, dq, ddq = motion()
    found, exceeded = measured_limits(robot, PLAIN, TIME, q, 1e-3 * dq, 1e-3 * ddq)
    assert set(found) == ALWAYS
    assert found["jerk_limited"] is False
    assert exceeded == []


MEASURES: dict[str, Callable[..., np.ndarray]] = {
    "jerk": lambda _robot, _q, _dq, ddq: jerk_ratios(TIME, ddq, np.ones(7)),
    "torque": lambda robot, q, dq, ddq: torque_ratios(
        robot, q, dq, ddq, np.ones(7), 0.0, np.zeros(3)
    ),
}


@pytest.mark.parametrize("kind", MEASURES)
@pytest.mark.parametrize(
    ("over", "broken"), [(-1e-3, False), (5e-10, False), (5e-9, True), (1e-3, True)]
)
def test_a_limit_of_a_joint_is_broken_beyond_rounding(kind: str, over: float, broken: bool) -> None:
    robot, q, dq, ddq = motion()
    most = MEASURES[kind](robot, q, dq, ddq)
    row, joint = np.unravel_index(most.argmax(), most.shape)
    limit = np.full(7, most[row, joint] / (1.0 + over))
    changed: dict[str, Any] = {kind: limit}
    limits = replace(PLAIN, **changed)
    found, exceeded = measured_limits(robot, limits, TIME, q, dq, ddq)
    assert found["jerk_limited"] == (kind == "jerk")
    assert set(found) == {*ALWAYS, f"{kind}_limit_ratio", f"{kind}_limit_at"}
    assert found[f"{kind}_limit_ratio"] == pytest.approx(1.0 + over, rel=1e-12)
    place = found[f"{kind}_limit_at"]
    assert (place.joint, place.time) == (robot.joint_names[joint], TIME[row])
    words = f"the {kind} limit of {robot.joint_names[joint]} is exceeded at {TIME[row]:.4f} s"
    assert exceeded == ([words] if broken else [])


@pytest.mark.parametrize("kind", ["speed", "acceleration"])
@pytest.mark.parametrize("part", [0, 1])
@pytest.mark.parametrize(
    ("over", "broken"), [(-1e-3, False), (5e-10, False), (5e-9, True), (1e-3, True)]
)
def test_a_limit_of_the_tool_is_broken_beyond_rounding(
    kind: str, part: int, over: float, broken: bool
) -> None:
    robot, q, dq, ddq = motion()
    one = (1.0, INF) if part == 0 else (INF, 1.0)
    most = (
        tool_speed_ratios(robot, q, dq, one)
        if kind == "speed"
        else tool_acceleration_ratios(robot, q, dq, ddq, one)
    )
    row = int(most.argmax())
    limit = tuple(value * most[row] / (1.0 + over) for value in one)
    changed: dict[str, Any] = {f"tool_{kind}": limit}
    limits = replace(PLAIN, **changed)
    found, exceeded = measured_limits(robot, limits, TIME, q, dq, ddq)
    assert set(found) == {*ALWAYS, f"tool_{kind}_ratio", f"tool_{kind}_time"}
    assert found[f"tool_{kind}_ratio"] == pytest.approx(1.0 + over, rel=1e-12)
    assert found[f"tool_{kind}_time"] == TIME[row]
    words = f"the tool {kind} limit is exceeded at {TIME[row]:.4f} s"
    assert exceeded == ([words] if broken else [])


def divisor(value: float, ratio: float) -> float:
    """A number by which ``value`` is exactly ``ratio`` times as large, in floating point."""
    near = value / ratio
    below = [near]
    for _ in range(8):
        below = [np.nextafter(below[0], 0.0), *below, np.nextafter(below[-1], np.inf)]
    return next(float(d) for d in below if value / d == ratio)


def test_a_ratio_of_one_and_the_rounding_allowed_is_within_the_limit() -> None:
    robot, q, dq, ddq = motion()
    most = jerk_ratios(TIME, ddq, np.ones(7))
    row, joint = np.unravel_index(most.argmax(), most.shape)
    jerk = np.full(7, np.inf)
    jerk[joint] = divisor(float(most[row, joint]), 1.0 + RATIO_SLACK)
    found, exceeded = measured_limits(robot, replace(PLAIN, jerk=jerk), TIME, q, dq, ddq)
    assert (found["jerk_limit_ratio"], exceeded) == (1.0 + RATIO_SLACK, [])
    speed = float(tool_speed_ratios(robot, q, dq, (1.0, INF)).max())
    limit = (divisor(speed, 1.0 + RATIO_SLACK), INF)
    found, exceeded = measured_limits(robot, replace(PLAIN, tool_speed=limit), TIME, q, dq, ddq)
    assert (found["tool_speed_ratio"], exceeded) == (1.0 + RATIO_SLACK, [])


def test_a_position_at_its_limit_and_the_rounding_allowed_is_within_it() -> None:
    robot = robot_of([Joint("revolute", lower=-1.0, upper=1.0)])
    found, exceeded = measured_positions(robot, TIME[:1], np.array([[1.0 + RATIO_SLACK]]))
    assert (found["position_limit_ratio"], exceeded) == (1.0 + RATIO_SLACK, [])


def test_the_payload_of_the_limits_counts() -> None:
    robot, q, dq, ddq = motion()
    at = np.array([0.0, 0.1, 0.2])
    limits = replace(PLAIN, torque=np.full(7, 50.0), payload_mass=3.0, payload_position=at)
    found, _ = measured_limits(robot, limits, TIME, q, dq, ddq)
    expected = torque_ratios(robot, q, dq, ddq, np.full(7, 50.0), 3.0, at)
    assert found["torque_limit_ratio"] == expected.max()


def test_what_is_not_a_number_breaks_a_limit() -> None:
    robot, q, dq, ddq = motion()
    ddq[2, 3] = np.nan
    limits = replace(PLAIN, jerk=np.full(7, 1e9))
    _, exceeded = measured_limits(robot, limits, TIME, q, dq, ddq)
    assert [words.split()[1] for words in exceeded] == ["acceleration", "jerk"]
    q[1, 2] = np.nan
    assert len(measured_positions(robot, TIME, q)[1]) == 1


DIFFERENT = replace(
    PLAIN,
    velocity=np.linspace(1.0, 2.0, 7),
    velocity_lower=-np.linspace(0.25, 0.5, 7),
    acceleration=np.linspace(4.0, 8.0, 7),
    acceleration_lower=-np.linspace(2.0, 3.0, 7),
)


@pytest.mark.parametrize("kind", ["velocity", "acceleration"])
@pytest.mark.parametrize("way", ["", "_lower"])
@pytest.mark.parametrize(("over", "broken"), [(-0.01, False), (5e-10, False), (5e-9, True)])
def test_a_rate_is_limited_in_its_own_direction_up_to_rounding(
    kind: str, way: str, over: float, broken: bool
) -> None:
    robot, q, *_ = motion()
    rates = {"velocity": np.zeros((4, 7)), "acceleration": np.zeros((4, 7))}
    rates[kind][2, 3] = (1.0 + over) * getattr(DIFFERENT, f"{kind}{way}")[3]
    rates[kind][1, 4] = 0.5 * getattr(DIFFERENT, f"{kind}{way}")[4]
    found, exceeded = measured_limits(
        robot, DIFFERENT, TIME, q, rates["velocity"], rates["acceleration"]
    )
    assert found[f"{kind}_limit_ratio"] == pytest.approx(1.0 + over, rel=1e-12)
    place = found[f"{kind}_limit_at"]
    assert (place.joint, place.time) == (robot.joint_names[3], TIME[2])
    other = {"velocity": "acceleration", "acceleration": "velocity"}[kind]
    assert found[f"{other}_limit_ratio"] == 0.0
    words = f"the {kind} limit of {robot.joint_names[3]} is exceeded at {TIME[2]:.4f} s"
    assert exceeded == ([words] if broken else [])


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("over", "broken"), [(-0.01, False), (5e-10, False), (5e-9, True)])
def test_a_position_is_limited_on_both_sides_of_the_middle(
    side: float, over: float, broken: bool
) -> None:
    robot = load_robot("panda")
    half, middle = 0.5 * (robot.upper - robot.lower), 0.5 * (robot.upper + robot.lower)
    q = np.tile(middle, (4, 1))
    q[2, 3] += side * (1.0 + over) * half[3]
    q[1, 5] -= side * 0.5 * half[5]
    found, exceeded = measured_positions(robot, TIME, q)
    assert found["position_limit_ratio"] == pytest.approx(1.0 + over, rel=1e-12)
    place = found["position_limit_at"]
    assert (place.joint, place.time) == (robot.joint_names[3], TIME[2])
    words = f"the position limit of {place.joint} is exceeded at {TIME[2]:.4f} s"
    assert exceeded == ([words] if broken else [])


def test_joints_without_end_have_no_position_limit() -> None:
    robot = robot_of([Joint("continuous"), Joint("revolute", lower=-1.0, upper=3.0)])
    q = np.array([[0.0, 1.0], [90.0, 2.0], [-90.0, 0.5], [0.0, 1.0]])
    found, exceeded = measured_positions(robot, TIME, q)
    assert found["position_limit_ratio"] == pytest.approx(0.5)
    assert found["position_limit_at"].time == TIME[1]
    assert exceeded == []
    wheel = robot_of([Joint("continuous")])
    found, exceeded = measured_positions(wheel, TIME, q[:, :1])
    assert found == {"position_limit_ratio": 0.0, "position_limit_at": None}
    assert exceeded == []
