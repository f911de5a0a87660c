"""Arms whose joint values move several serial joints at once."""

from __future__ import annotations

from typing import Any

import numpy as np

import ikplan
from ikplan.robots import load_robot

START = [-0.23131752, 0.52162778, 0.43869583, 0.25198363]
POSITIONS = [
    [0.11417255, -0.0926688, 0.07381574],
    [0.28565516, -0.0661334, 0.1863784],
    [0.24028485, 0.04489482, -0.01890085],
    [0.0, -0.3016994, 0.0528192],
    [0.19097082, 0.05069437, -0.07721899],
]
ABOUT_Z = [-0.28585, -0.07769, 0.87549, 3.54451, -1.19716]


def through(orientations: list[list[float]]) -> dict[str, Any]:
    """A joint motion of a palletiser, whose second value tilts two serial joints."""
    waypoints = [
        {"position": p, "quaternion_xyzw": q} for p, q in zip(POSITIONS, orientations, strict=True)
    ]
    return {
        "robot": "dobot_magician",
        "start": START,
        "path": {"waypoints": waypoints},
        "scene": {"self_collision": False},
    }


def upright(angles: list[float]) -> list[list[float]]:
    return [[0.0, 0.0, float(np.sin(0.5 * a)), float(np.cos(0.5 * a))] for a in angles]


def test_far_waypoints_of_an_arm_with_coupled_joints_are_planned() -> None:
    plan = ikplan.plan(through(upright(ABOUT_Z)))
    robot = load_robot("dobot_magician")
    assert np.abs(np.diff(plan.waypoints.q, axis=0)).max() > 1.0  # as far as a flip
    for q, position in zip(plan.waypoints.q, POSITIONS, strict=True):
        np.testing.assert_allclose(robot.fk(q).translation, position, atol=1e-6)
