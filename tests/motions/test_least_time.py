"""Least time as the objective of plans."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.documents import parse
from ikplan.documents.requests.ik import IkRequest


def waypoints(robot: ikplan.Robot, seed: int, n: int) -> list[dict[str, Any]]:
    rng = np.random.default_rng(seed)
    low, high = np.maximum(robot.lower, -2.0), np.minimum(robot.upper, 2.0)
    poses = [robot.fk(rng.uniform(low, high)) for _ in range(n)]
    return [{"position": pose.translation.tolist()} for pose in poses]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_least_time_is_never_slower_than_least_motion_and_says_what_it_gains(seed: int) -> None:
    robot = ikplan.load_robot("kuka_kr6_r700_sixx")
    request = {
        "robot": "kuka_kr6_r700_sixx",
        "path": {"waypoints": waypoints(robot, seed, 4)},
        "scene": {"self_collision": False},
        "limits": {"jerk": False},
    }
    least = ikplan.plan(request)
    fast = ikplan.plan({**request, "ik": {"objective": "time"}})
    assert fast.objective is not None
    assert least.objective is None
    assert fast.duration <= least.duration
    assert fast.objective.least_motion_duration == pytest.approx(least.duration, abs=1e-12)
    assert fast.objective.length >= fast.objective.least_motion_length * (1.0 - 1e-6)
    assert fast.id != least.id


def test_poses_have_no_motion_time() -> None:
    document = {"robot": "ur5", "position": [0.4, 0.2, 0.3], "ik": {"objective": "time"}}
    with pytest.raises(ikplan.InvalidRequest):
        parse(IkRequest, document)
