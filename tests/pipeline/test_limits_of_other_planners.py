"""Requests that other planners refuse or slow down, which are planned within all limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.robots import load_robot


def test_a_tool_speed_above_what_the_joints_allow_is_planned_within_their_limits() -> None:
    """Pilz, CIRCCmdToFast, LINCmdLimitViolation and velScaleToHigh, which end in a failure."""
    robot = load_robot("panda")
    T = robot.fk(robot.home)
    begin, down = T.translation, {"quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]}
    end = {"position": (begin + np.array([0.0, 0.2, 0.0])).tolist(), **down}
    for segment in (
        {"type": "line", "to": end},
        {"type": "arc", "centre": (begin + np.array([0.0, 0.1, 0.0])).tolist(), "angle": 3.0},
    ):
        request = {
            "robot": "panda",
            "start": robot.home.tolist(),
            "path": {"segments": [segment]},
            "limits": {"tool_speed": 100.0, "tool_acceleration": 1000.0},
            "scene": {"self_collision": False},
        }
        plan = ikplan.plan(request)
        assert plan.certificate.valid
        assert (np.abs(plan.dq) <= robot.velocity_limit * (1.0 + 1e-9)).all()
        assert (np.abs(plan.ddq) <= robot.acceleration_limit * (1.0 + 1e-9)).all()
        assert max(
            plan.certificate.velocity_limit_ratio,
            plan.certificate.acceleration_limit_ratio,
            plan.certificate.jerk_limit_ratio or 0.0,
        ) == pytest.approx(1.0, abs=0.02)


def test_a_rounded_corner_keeps_the_norm_of_the_tools_acceleration() -> None:
    """KDL's trajectory_example: its trapezoid along the path breaks the limit in the corner."""
    robot = load_robot("ur5")
    q = np.array([0.3, -1.2, 1.6, -1.9, -1.5, 0.2])
    T = robot.fk(q)
    corner = T.translation + np.array([0.0, 0.2, 0.0])
    end = corner + np.array([0.0, 0.0, 0.2])
    request: dict[str, Any] = {
        "robot": "ur5",
        "start": q.tolist(),
        "path": {
            "segments": [
                {"type": "line", "to": {"position": corner.tolist()}, "blend": 0.05},
                {"type": "line", "to": {"position": end.tolist()}},
            ]
        },
        "limits": {"tool_speed": 1.0, "tool_acceleration": 0.1},
        "scene": {"self_collision": False},
        "sampling": {"rate_hz": 1000.0},
    }
    plan = ikplan.plan(request)
    _, p = robot.poses(np.array(plan.q))
    dt = np.diff(plan.time)[0]
    speed = np.diff(p[:-1], axis=0) / dt
    pull = np.linalg.norm(np.diff(speed, axis=0) / dt, axis=1)
    assert np.quantile(pull, 0.999) <= 0.1 * 1.01
    # A trapezoid along the sides alone, with a stop in the corner, is the longest sensible motion.
    assert plan.duration <= 2.0 * 2.0 * np.sqrt(0.2 / 0.1) + 1e-2
    # And none is shorter than that along the chord from the begin to the end.
    assert plan.duration >= 2.0 * np.sqrt(np.linalg.norm(end - T.translation) / 0.1)
