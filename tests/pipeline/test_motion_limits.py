"""Limits of a robot, a request and its segments are merged by the strictest, in every field."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan import InvalidRequest, load_robot
from ikplan.documents.limits import LimitOptions, SegmentLimits
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot, robot_from_urdf
from tests.present import present

PANDA = load_robot("panda")
RATES = ("velocity", "velocity_lower", "acceleration", "acceleration_lower")
EVERY = (*RATES, "jerk", "torque", "tool_speed", "tool_acceleration")
LOAD = {"mass": 2.0, "position": [0.1, 0.2, 0.3]}


def per_joint(low: float, high: float) -> st.SearchStrategy[Any]:
    """A number for all joints, or one for each."""
    number = st.floats(low, high)
    return number | st.lists(number, min_size=PANDA.dof, max_size=PANDA.dof)


rate = st.floats(1e-3, 50.0)
tool = rate | st.fixed_dictionaries({}, optional={"linear": rate, "angular": rate})
options = st.fixed_dictionaries(
    {},
    optional={
        "velocity_scale": st.floats(0.1, 1.0),
        "acceleration_scale": st.floats(0.1, 1.0),
        "velocity": per_joint(0.01, 5.0),
        "velocity_lower": per_joint(-5.0, -0.01),
        "acceleration": per_joint(0.1, 30.0),
        "acceleration_lower": per_joint(-30.0, -0.1),
        "jerk": per_joint(1.0, 1e4),
        "torque": st.booleans() | st.lists(st.floats(1.0, 200.0), min_size=7, max_size=7),
        "tool_speed": tool,
        "tool_acceleration": tool,
    },
)


def arrays(limits: MotionLimits) -> dict[str, np.ndarray]:
    """Every limit as numbers; inf where there is none."""
    found = {}
    for name in EVERY:
        value = getattr(limits, name)
        found[name] = np.full(7, np.inf) if value is None else np.asarray(value, dtype=float)
    return found


def asked(document: dict[str, Any]) -> dict[str, list[float]]:
    """What one document asks for by itself, the robot's own limits included, joint by joint."""
    found: dict[str, list[float]] = {}
    for kind in ("velocity", "acceleration"):
        own = [document.get(f"{kind}_scale", 1.0) * v for v in getattr(PANDA, f"{kind}_limit")]

        def each(name: str) -> list[float] | None:
            value = document.get(name)
            return value if value is None or isinstance(value, list) else [value] * 7

        above, below = each(kind), each(f"{kind}_lower")
        found[kind] = own if above is None else [min(a, b) for a, b in zip(own, above, strict=True)]
        found[f"{kind}_lower"] = (
            [-v for v in found[kind]]
            if below is None
            else [max(-a, b) for a, b in zip(own, below, strict=True)]
        )
    jerk, torque = document.get("jerk", np.inf), document.get("torque", False)
    jerks = jerk if isinstance(jerk, list) else [jerk] * 7
    found["jerk"] = [min(a, b) for a, b in zip(present(PANDA.jerk_limit), jerks, strict=True)]
    effort = list(PANDA.effort_limit) if torque is not False else [np.inf] * 7
    own_torque = torque if isinstance(torque, list) else [np.inf] * 7
    found["torque"] = [min(a, b) for a, b in zip(effort, own_torque, strict=True)]
    for name in ("tool_speed", "tool_acceleration"):
        value = document.get(name, {})
        parts = value if isinstance(value, dict) else {"linear": value}
        found[name] = [parts.get("linear", np.inf), parts.get("angular", np.inf)]
    return found


@given(st.lists(options, min_size=1, max_size=3))
@settings(deadline=None, max_examples=150)
def test_the_strictest_of_all_holds_in_every_field(documents: list[dict[str, Any]]) -> None:
    limits = MotionLimits.of(PANDA, LimitOptions.model_validate(documents[0]))
    for k, document in enumerate(documents[1:]):
        limits = limits.within(PANDA, SegmentLimits.model_validate(document), f"segments[{k}]")
    each = [asked(document) for document in documents]
    for name, value in arrays(limits).items():
        strictest = max if name.endswith("_lower") else min
        expected = [strictest(row) for row in zip(*(a[name] for a in each), strict=True)]
        np.testing.assert_array_equal(value, expected, err_msg=name)


@given(options, options)
@settings(deadline=None, max_examples=60)
def test_the_order_of_the_merge_means_nothing(a: dict[str, Any], b: dict[str, Any]) -> None:
    plain = MotionLimits.of(PANDA, LimitOptions())
    one, other = SegmentLimits.model_validate(a), SegmentLimits.model_validate(b)
    both = arrays(plain.within(PANDA, one, "a").within(PANDA, other, "b"))
    swapped = arrays(plain.within(PANDA, other, "b").within(PANDA, one, "a"))
    again = arrays(plain.within(PANDA, one, "a").within(PANDA, other, "b").within(PANDA, one, "a"))
    for name, value in both.items():
        np.testing.assert_array_equal(value, swapped[name], err_msg=name)
        np.testing.assert_array_equal(value, again[name], err_msg=name)


def test_without_a_request_the_limits_are_the_robots() -> None:
    limits = MotionLimits.of(PANDA, LimitOptions())
    np.testing.assert_array_equal(limits.velocity, PANDA.velocity_limit)
    np.testing.assert_array_equal(limits.velocity_lower, -PANDA.velocity_limit)
    np.testing.assert_array_equal(limits.acceleration, PANDA.acceleration_limit)
    np.testing.assert_array_equal(limits.acceleration_lower, -PANDA.acceleration_limit)
    np.testing.assert_array_equal(limits.jerk, PANDA.jerk_limit)
    assert limits.jerk_source == "controller"
    assert limits.torque is None
    assert limits.tool_speed == limits.tool_acceleration == (np.inf, np.inf)
    assert limits.payload_mass == 0.0
    np.testing.assert_array_equal(limits.payload_position, np.zeros(3))


def test_a_payload_is_carried_on_until_another_one_is() -> None:
    whole = MotionLimits.of(PANDA, LimitOptions.model_validate({"torque": True, "payload": LOAD}))
    assert whole.payload_mass == 2.0
    np.testing.assert_array_equal(whole.payload_position, LOAD["position"])
    same = whole.within(PANDA, SegmentLimits(velocity_scale=0.5), "segments[0]")
    assert same.payload_mass == 2.0
    np.testing.assert_array_equal(same.payload_position, LOAD["position"])
    other = {"payload": {"mass": 0.5, "position": [0.0, 0.0, 0.1]}}
    changed = whole.within(PANDA, SegmentLimits.model_validate(other), "segments[0]")
    assert changed.payload_mass == 0.5
    np.testing.assert_array_equal(changed.payload_position, [0.0, 0.0, 0.1])


def refused(robot: Robot, document: dict[str, Any], field: str = "limits") -> InvalidRequest:
    with pytest.raises(InvalidRequest) as caught:
        MotionLimits.of(robot, LimitOptions()).within(
            robot, SegmentLimits.model_validate(document), field
        )
    return caught.value


@pytest.mark.parametrize("count", [1, 6, 8])
@pytest.mark.parametrize("name", [*RATES, "jerk", "torque"])
def test_a_list_of_another_length_is_refused_with_its_field(name: str, count: int) -> None:
    value = -1.0 if name.endswith("_lower") else 1.0
    error = refused(PANDA, {name: [value] * count}, "segments[3].limits")
    assert error.field == f"segments[3].limits.{name}"
    assert error.allowed == "7 numbers"
    assert f"got {count}" in error.detail


def test_torques_are_asked_only_of_robots_whose_inertias_have_a_source() -> None:
    for asked_for in (True, [100.0] * 7):
        error = refused(load_robot("iiwa14"), {"torque": asked_for})
        assert error.field == "limits.torque"
        assert "no sourced inertias" in error.detail


def test_a_payload_without_torques_is_refused() -> None:
    error = refused(PANDA, {"payload": LOAD}, "segments[1].limits")
    assert error.field == "segments[1].limits.payload"


LINK = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
JOINT = (
    '<joint name="j{k}" type="revolute"><parent link="l{k}"/><child link="l{n}"/>'
    '<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="{effort}"/></joint>'
)


def two_joints(first: float, second: float) -> Robot:
    """An arm with these torque limits; 0 stands for one that is not known."""
    links = "".join(f'<link name="l{k}">{LINK}</link>' for k in range(3))
    joints = JOINT.format(k=0, n=1, effort=first) + JOINT.format(k=1, n=2, effort=second)
    return robot_from_urdf(f'<robot name="two">{links}{joints}</robot>')


def test_a_torque_limit_that_no_source_gives_is_asked_for() -> None:
    robot = two_joints(5.0, 0.0)
    assert robot.info().inertias_sourced
    error = refused(robot, {"torque": True})
    assert error.field == "limits.torque"
    assert "is known for j1 of" in error.detail
    limits = MotionLimits.of(robot, LimitOptions(torque=[9.0, 7.0]))
    assert limits.torque is not None
    assert limits.torque.tolist() == [5.0, 7.0]


def test_a_torque_limit_may_be_small() -> None:
    limits = MotionLimits.of(two_joints(5.0, 0.01), LimitOptions(torque=True))
    assert limits.torque is not None
    assert limits.torque.tolist() == [5.0, 0.01]
