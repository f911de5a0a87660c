"""Waypoints that a joint would meet a hair past its limit: met at the limit, within tolerance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import ikplan
from ikplan.path.rotation.so3 import quaternion_of
from ikplan.robots import Robot

Array = NDArray[np.float64]


def stations(robot: Robot, joint: int, past: float) -> dict[str, Any]:
    """Five stations; in the middle one, a joint is past its upper limit."""
    q = np.array([0.7, 0.7, 1.0, -0.5, 0.8, 0.4])
    q[joint] = robot.upper[joint] + past
    away = np.eye(6)[joint]
    poses = [robot.fk(q - x * away) for x in (0.02, 0.01, 0.0, 0.01, 0.02)]
    waypoints = [
        {
            "position": T.translation.tolist(),
            "quaternion_xyzw": quaternion_of(T.rotation).tolist(),
        }
        for T in poses
    ]
    return {
        "robot": robot.name,
        "start": (q - 0.03 * away).tolist(),
        "path": {"waypoints": waypoints},
        "scene": {"self_collision": False},
    }


@pytest.mark.parametrize("joint", [0, 1, 3, 4, 5])
@pytest.mark.parametrize("past", [1e-7, 5e-5])
def test_a_station_a_hair_past_a_limit_costs_no_turn(joint: int, past: float) -> None:
    robot = ikplan.load_robot("ur3")
    plan = ikplan.plan(stations(robot, joint, past))
    assert np.abs(np.diff(plan.waypoints.q, axis=0)).max() < 0.02
    assert plan.waypoints.q[2, joint] == pytest.approx(robot.upper[joint], abs=1e-9)
    # Off by the hair at that station alone.
    off = np.array(plan.waypoints.orientation_error, dtype=float)
    assert off[2] == pytest.approx(past, rel=1e-3)
    assert off[[0, 1, 3, 4]].max() < 1e-9
    assert plan.certificate.max_position_error is not None
    assert plan.certificate.max_position_error <= 1e-4


def test_a_station_farther_past_a_limit_than_the_tolerance_is_met_exactly() -> None:
    robot = ikplan.load_robot("ur3")
    plan = ikplan.plan(stations(robot, 0, 2e-3))
    assert plan.certificate.max_position_error is not None
    assert plan.certificate.max_position_error < 1e-9


@pytest.mark.parametrize("joint", [0, 3, 5])
def test_a_line_may_begin_a_hair_past_a_limit(joint: int) -> None:
    robot = ikplan.load_robot("ur5")
    request = stations(robot, joint, 5e-5)
    waypoints = request["path"]["waypoints"]
    to_station = {"type": "joint", "to": waypoints[2]}
    away = {"type": "line", "to": waypoints[0]}
    plan = ikplan.plan({**request, "path": {"segments": [to_station, away]}})
    assert np.abs(plan.q - request["start"]).max() < 0.1
    assert plan.certificate.max_position_error is not None
    assert plan.certificate.max_position_error <= 1e-4
