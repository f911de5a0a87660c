"""What a limit may be: the ends of every range, and the form of every field."""

from __future__ import annotations

import math
from typing import Any

import pytest

from ikplan import InvalidRequest
from ikplan.documents import parse
from ikplan.documents.limits import LimitOptions, SamplingOptions

RANGES = {
    "velocity_scale": (1e-4, 1.0),
    "acceleration_scale": (1e-4, 1.0),
    "velocity": (1e-6, 1e9),
    "velocity_lower": (-1e9, -1e-6),
    "acceleration": (1e-6, 1e9),
    "acceleration_lower": (-1e9, -1e-6),
    "jerk": (1e-6, 1e9),
    "tool_speed": (1e-6, 1e9),
    "tool_acceleration": (1e-6, 1e9),
}
LISTS = ("velocity", "velocity_lower", "acceleration", "acceleration_lower", "jerk")


def refused(document: dict[str, Any]) -> InvalidRequest:
    with pytest.raises(InvalidRequest) as caught:
        parse(LimitOptions, document)
    return caught.value


def just_outside(low: float, high: float) -> tuple[float, float]:
    return math.nextafter(low, -math.inf), math.nextafter(high, math.inf)


@pytest.mark.parametrize("name", RANGES)
def test_a_number_may_be_what_its_range_says_and_nothing_beyond(name: str) -> None:
    for value in RANGES[name]:
        assert getattr(parse(LimitOptions, {name: value}), name) == value
    for value in just_outside(*RANGES[name]):
        assert refused({name: value}).field == name


@pytest.mark.parametrize("name", LISTS)
def test_a_list_may_hold_what_a_number_may_be(name: str) -> None:
    ends = list(RANGES[name])
    assert getattr(parse(LimitOptions, {name: ends}), name) == ends
    for value in just_outside(*RANGES[name]):
        assert refused({name: [ends[0], value]}).field == f"{name}[1]"
    assert refused({name: []}).field == name
    assert len(getattr(parse(LimitOptions, {name: ends * 500}), name)) == 1000
    assert refused({name: ends * 500 + ends[:1]}).field == name


def test_torques_are_a_flag_or_a_list() -> None:
    assert parse(LimitOptions, {"torque": True}).torque is True
    assert parse(LimitOptions, {"torque": [1e-6, 1e9]}).torque == [1e-6, 1e9]
    for value in (1.0, 1, "true", None, {"linear": 1.0}):
        assert refused({"torque": value}).field == "torque"
    assert refused({"torque": [0.0]}).field == "torque[0]"
    assert refused({"torque": [True]}).field == "torque[0]"


@pytest.mark.parametrize("name", ["tool_speed", "tool_acceleration"])
def test_a_rate_of_the_tool_is_a_number_or_two(name: str) -> None:
    for part in ("linear", "angular"):
        rate = getattr(parse(LimitOptions, {name: {part: 1e-6}}), name)
        other = {"linear": "angular", "angular": "linear"}[part]
        assert getattr(rate, part) == 1e-6
        assert getattr(rate, other) is None
        for value in just_outside(1e-6, 1e9):
            assert refused({name: {part: value}}).field == f"{name}.{part}"
    for wrong in (True, [1.0], "1"):
        assert refused({name: wrong}).field == name


def test_a_payload_has_a_mass_and_a_place() -> None:
    for mass in (0.0, 1e4):
        payload = parse(LimitOptions, {"payload": {"mass": mass}}).payload
        assert payload is not None
        assert payload.mass == mass
        assert list(payload.position) == [0.0, 0.0, 0.0]
    for mass in just_outside(0.0, 1e4):
        assert refused({"payload": {"mass": mass}}).field == "payload.mass"
    assert refused({"payload": {"position": [0.0, 0.0, 0.0]}}).field == "payload.mass"
    assert refused({"payload": {"mass": 1.0, "position": [0.0, 0.0]}}).field.startswith("payload.")


def test_nothing_said_limits_nothing() -> None:
    limits = parse(LimitOptions, {})
    assert limits.velocity_scale == limits.acceleration_scale == 1.0
    assert limits.torque is False
    for name in (*LISTS, "payload", "tool_speed", "tool_acceleration"):
        assert getattr(limits, name) is None


def test_the_rate_of_samples_is_between_one_and_ten_thousand() -> None:
    assert parse(SamplingOptions, {}).rate_hz is None
    for value in (1.0, 10_000.0):
        assert parse(SamplingOptions, {"rate_hz": value}).rate_hz == value
    for value in just_outside(1.0, 10_000.0):
        with pytest.raises(InvalidRequest) as caught:
            parse(SamplingOptions, {"rate_hz": value})
        assert caught.value.field == "rate_hz"
