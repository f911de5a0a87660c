"""The comparison with other libraries: ratios beside ikplan, and what is missing is left out."""

from __future__ import annotations

import json

import pytest

from benchmarks.peers import lines
from benchmarks.peers.measure import Contestant, compare, module
from ikplan.robots import load_robot


def busy(count: int) -> object:
    return sum(k * k for k in range(count))


def test_the_ratio_is_to_the_first_contestant() -> None:
    contestants = [
        Contestant("ikplan", [lambda: busy(2_000)] * 3),
        Contestant("slower", [lambda: busy(40_000)] * 3, "a note"),
    ]
    first, second = compare("sums", contestants, 3)
    assert (first.beside, first.work, first.name) == (1.0, "sums", "ikplan")
    assert second.beside == pytest.approx(second.seconds / first.seconds)
    assert 5.0 < second.beside < 80.0
    assert second.note == "a note"


def test_a_library_that_is_not_installed_is_left_out() -> None:
    assert module("no_such_library_anywhere") is None
    assert module("json") is json


def test_the_peer_is_given_the_limits_that_ikplan_plans_with() -> None:
    robot = load_robot("ur5")
    given = lines._limits(robot)
    assert list(given) == list(robot.joint_names)
    assert given["elbow_joint"]["max_velocity"] == [robot.velocity_limit[2]]
    assert given["elbow_joint"]["max_acceleration"] == [robot.acceleration_limit[2]]
