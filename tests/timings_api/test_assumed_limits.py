"""Accelerations above a named default of the robot hold; above limits with a source they do not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.robots import Robot
from tests.present import present

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


def test_an_acceleration_asked_for_holds_in_place_of_a_default(assumed: Robot) -> None:
    """0.7 rad at 28 rad/s^2 take 2 sqrt(0.7 / 28) s where the speed limit is not reached."""
    plan = timed(assumed, acceleration=[28.0, 20.0])
    assert plan.duration == pytest.approx(2.0 * np.sqrt(0.7 / 28.0), abs=0.01)
    # The motion is slowed to end at a sample.
    assert np.abs(plan.ddq[:, 0]).max() == pytest.approx(28.0, rel=0.01)
    assert plan.certificate.acceleration_limit_ratio == pytest.approx(1.0, abs=0.01)
    assert present(plan.timing).hints == []


def test_joints_and_directions_that_nothing_is_asked_for_keep_the_default(assumed: Robot) -> None:
    one, two = assumed.acceleration_limit
    plan = timed(assumed, acceleration=[5.0, 20.0])
    assert np.abs(plan.ddq[:, 0]).max() <= 5.0 * (1.0 + 1e-9)
    down = timed(assumed, acceleration_lower=-28.0)
    assert down.ddq[:, 0].max() <= one * (1.0 + 1e-9)
    assert down.ddq[:, 0].min() < -1.5 * one
    assert (np.abs(timed(assumed).ddq) <= np.array([one, two]) * (1.0 + 1e-9)).all()


def test_a_deceleration_asked_for_holds_in_place_of_a_default(assumed: Robot) -> None:
    one = assumed.acceleration_limit[0]
    plan = timed(assumed, deceleration=[28.0, 20.0])
    assert plan.ddq[:, 0].max() <= one * (1.0 + 1e-9)
    assert plan.ddq[:, 0].min() < -1.5 * one


def test_a_scale_is_of_what_was_asked_for(assumed: Robot) -> None:
    plan = timed(assumed, acceleration=[28.0, 20.0], acceleration_scale=0.5)
    assert np.abs(plan.ddq[:, 0]).max() == pytest.approx(14.0, rel=0.01)


def test_what_is_asked_of_the_robot_itself_holds_and_nothing_is_told(
    file: Path, assumed: Robot
) -> None:
    """0.7 rad at 28 rad/s^2 take 2 sqrt(0.7 / 28) s where the speed limit is not reached."""
    own = {"one": {"acceleration": 28.0}, "two": {"acceleration": 20.0}}
    robot = ikplan.load_robot(file, limits=own)
    plan = timed(robot, acceleration=[28.0, 20.0])
    assert present(plan.timing).hints == []
    assert plan.duration == pytest.approx(2.0 * np.sqrt(0.7 / 28.0), abs=0.01)
    assert present(timed(assumed, acceleration=1.0).timing).hints == []
    assert present(timed(assumed).timing).hints == []


def test_a_limit_with_a_source_holds_and_that_is_told() -> None:
    robot = ikplan.load_robot("panda")
    way = [robot.home, robot.home + 0.1]
    plan = ikplan.time_path(robot, way, limits={"acceleration": 1e6}, rate_hz=1000)
    assert (np.abs(plan.ddq) <= robot.acceleration_limit * (1.0 + 1e-9)).all()
    (hint,) = [h for h in present(plan.timing).hints if "a source gives them" in h]
    assert hint.startswith("limits.acceleration is above the robot's limits of panda_joint1 ")


def test_plans_take_it_too(assumed: Robot) -> None:
    asked = {
        "robot": "two",
        "start": WAY[0],
        "path": {"segments": [{"type": "joint", "q": WAY[1]}]},
        "limits": {"acceleration": 28.0},
    }
    plan = ikplan.plan(asked, robot=assumed)
    assert present(plan.timing).hints == []
    # At 250 Hz, slowed to end at a sample.
    assert np.abs(plan.ddq[:, 0]).max() == pytest.approx(28.0, rel=0.03)


def two_segments(**limits: Any) -> dict[str, Any]:
    """Two joint motions, the second one with an acceleration of its own above the default."""
    turn = {"type": "joint", "q": WAY[1]}
    back = {"type": "joint", "q": [-0.7, 0.1], "limits": {"acceleration": [28.0, 1.0]}}
    return {"robot": "two", "start": WAY[0], "path": {"segments": [turn, back]}, "limits": limits}


def test_an_acceleration_of_a_segment_above_that_of_the_path_is_told(assumed: Robot) -> None:
    plan = ikplan.plan(two_segments(), robot=assumed)
    (hint,) = present(plan.timing).hints
    assert hint.startswith("path.segments[1].limits.acceleration is above what holds for the whole")
    assert "limits.acceleration replaces what is only a named default" in hint
    assert np.abs(plan.ddq[:, 0]).max() <= assumed.acceleration_limit[0] * (1.0 + 1e-9)
    lifted = ikplan.plan(two_segments(acceleration=28.0), robot=assumed)
    assert present(lifted.timing).hints == []
    assert lifted.duration < 0.9 * plan.duration
    (said,) = present(ikplan.plan(two_segments(acceleration=20.0), robot=assumed).timing).hints
    assert "limits.acceleration says it" in said
