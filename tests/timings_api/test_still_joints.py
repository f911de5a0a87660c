"""A limit of 0 is that of a joint that does not move."""

from __future__ import annotations

import numpy as np
import pytest

import ikplan
from ikplan import InvalidRequest

ZEROS = [2.0, 0.0, 2.0, 2.0, 0.0, 2.0]


@pytest.mark.parametrize("kind", ["velocity", "acceleration", "jerk"])
def test_joints_that_stand_still_may_have_the_limit_0(kind: str) -> None:
    robot = ikplan.load_robot("ur5")
    there = robot.home + np.array([0.5, 0.0, -0.3, 0.2, 0.0, 0.1])
    least = {"jerk": [50.0, 50.0, 50.0, 50.0, 50.0, 50.0]} if kind == "jerk" else {}
    asked = [25.0 * x for x in ZEROS] if kind == "jerk" else ZEROS
    plan = ikplan.time_path(robot, [robot.home, there], limits={**least, kind: asked})
    free = [50.0] * 6 if kind == "jerk" else [2.0] * 6
    same = ikplan.time_path(robot, [robot.home, there], limits={kind: free})
    assert plan.duration == same.duration
    np.testing.assert_allclose(plan.q[:, [1, 4]] - robot.home[[1, 4]], 0.0, atol=1e-12)


@pytest.mark.parametrize("kind", ["velocity", "acceleration"])
def test_a_joint_that_moves_must_not_have_it(kind: str) -> None:
    robot = ikplan.load_robot("ur5")
    there = robot.home + np.array([0.5, 0.1, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(InvalidRequest, match="shoulder_lift_joint has the limit 0") as caught:
        ikplan.time_path(robot, [robot.home, there], limits={kind: ZEROS})
    assert caught.value.field == f"limits.{kind}"


@pytest.mark.parametrize("value", [0.0, [1.0, 1e-9, 1.0, 1.0, 1.0, 1.0], [-1.0] * 6])
def test_other_small_limits_are_refused(value: object) -> None:
    robot = ikplan.load_robot("ur5")
    with pytest.raises(InvalidRequest, match=r"limits\.velocity"):
        ikplan.time_path(robot, [robot.home, robot.home], limits={"velocity": value})
