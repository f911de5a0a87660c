"""Accelerations above limits that are only a named default of the robot: the answer tells."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.robots import Robot

URDF = """<robot name="two">
  <link name="base"/><link name="a"/><link name="b"/>
  <joint name="one" type="revolute"><parent link="base"/><child link="a"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="4.54" effort="1"/></joint>
  <joint name="two" type="revolute"><parent link="a"/><child link="b"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="2.0" effort="1"/></joint>
</robot>"""
WAY = [[0.0, 0.0], [0.7, 0.3]]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = Path(tmp_path_factory.mktemp("robots")) / "two.urdf"
    file.write_text(URDF)
    return file


@pytest.fixture(scope="module")
def assumed(file: Path) -> Robot:
    return ikplan.load_robot(file)


def timed(robot: Robot, **limits: Any) -> ikplan.Plan:
    return ikplan.time_path(robot, WAY, limits=limits, rate_hz=1000)


@pytest.mark.parametrize(
    ("limits", "names"),
    [
        ({"acceleration": [28.0, 20.0]}, "one 7.567, two 3.333"),
        ({"acceleration": [5.0, 20.0]}, "two 3.333"),
        ({"acceleration_lower": -28.0}, "one 7.567, two 3.333"),
        ({"deceleration": [28.0, 1.0]}, "one 7.567"),
    ],
)
def test_an_acceleration_above_a_default_is_told_and_the_default_holds(
    assumed: Robot, limits: dict[str, Any], names: str
) -> None:
    plan = timed(assumed, **limits)
    assert (np.abs(plan.ddq) <= assumed.acceleration_limit * (1.0 + 1e-9)).all()
    (hint,) = plan.timing.hints
    assert f"limits.{next(iter(limits))} is above" in hint
    assert f"limits of {names} rad" in hint


def test_what_is_asked_of_the_robot_itself_holds_and_nothing_is_told(
    file: Path, assumed: Robot
) -> None:
    """0.7 rad at 28 rad/s^2 take 2 sqrt(0.7 / 28) s where the speed limit is not reached."""
    own = {"one": {"acceleration": 28.0}, "two": {"acceleration": 20.0}}
    robot = ikplan.load_robot(file, limits=own)
    plan = timed(robot, acceleration=[28.0, 20.0])
    assert plan.timing.hints == []
    assert plan.duration == pytest.approx(2.0 * np.sqrt(0.7 / 28.0), abs=0.01)
    assert timed(assumed, acceleration=1.0).timing.hints == []
    assert timed(assumed).timing.hints == []


def test_a_limit_with_a_source_is_no_default() -> None:
    robot = ikplan.load_robot("panda")
    way = [robot.home, robot.home + 0.1]
    plan = ikplan.time_path(robot, way, limits={"acceleration": 1e6}, rate_hz=1000)
    assert not [h for h in plan.timing.hints if "default" in h]


def test_plans_tell_it_too(assumed: Robot) -> None:
    asked = {
        "robot": "two",
        "start": WAY[0],
        "path": {"segments": [{"type": "joint", "q": WAY[1]}]},
        "limits": {"acceleration": 28.0},
    }
    (hint,) = ikplan.plan(asked, robot=assumed).timing.hints
    assert "one 7.567" in hint
