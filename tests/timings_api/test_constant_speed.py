"""A tool led along a line under a speed limit has one speed, that of the limit."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from tests.present import present


@pytest.mark.parametrize(
    ("name", "way", "limit", "jerk", "margin"),
    [
        ("panda", [-0.1, 0.3, -0.1], 0.2, False, 0.0),
        # A jerk-limited motion keeps a thousandth below every limit.
        ("panda", [-0.1, 0.3, -0.1], 0.2, None, 1e-3),
        ("ur5", [0.0, 0.2, -0.15], 0.1, None, 0.0),
    ],
)
def test_a_straight_line_runs_at_the_speed_of_its_limit(
    name: str, way: list[float], limit: float, jerk: bool | None, margin: float
) -> None:
    robot = ikplan.load_robot(name)
    pose = pin.SE3ToXYZQUAT(robot.fk(robot.home))
    end = {"position": (pose[:3] + way).tolist(), "quaternion_xyzw": pose[3:].tolist()}
    plan = ikplan.plan(
        {
            "robot": name,
            "path": {"waypoints": [end], "interpolation": "line"},
            "limits": {"tool_speed": limit, "jerk": jerk},
        }
    )
    speed = np.array(
        [
            np.linalg.norm((robot.jacobian(q) @ dq)[:3])
            for q, dq in zip(plan.q, plan.dq, strict=True)
        ]
    )
    middle = (plan.time > 0.1 * plan.duration) & (plan.time < 0.9 * plan.duration)
    # The motion is slowed to end at a sample, all of it alike.
    assert 1.0 <= present(plan.timing).grid_factor < 1.01
    assert speed[middle].min() >= (1.0 - margin) * limit / present(plan.timing).grid_factor - 1e-6
    assert speed.max() <= limit
    assert present(plan.timing).binding[0].limit == "tool_linear_speed"
    assert present(plan.timing).binding[0].share > 0.9
