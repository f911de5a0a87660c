"""Long sequences are shortened at few points first."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import load_robot
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.ladder.motion_cost import plain_cost, sequence_cost
from ikplan.planning.tracking import path_tracker
from ikplan.planning.tracking.coarse_shortening import shortened, shortened_coarse_first
from ikplan.planning.tracking.tracking_kernels import errors_at, project_onto_targets
from ikplan.planning.waypoints.stack import stack_targets


def test_a_long_sequence_stays_on_its_targets_and_is_no_longer() -> None:
    """Along a circle that the redundant arm drifts away on, in both ways from one sequence."""
    robot = load_robot("iiwa14")
    arm, n = arm_of(robot), 600
    begin = robot.fk(np.array(robot.home))
    turn = np.linspace(0.0, 4.0 * np.pi, n + 1)[1:]
    circle = 0.08 * np.stack([np.cos(turn) - 1.0, np.sin(turn), 0.0 * turn], axis=1)
    poses = [pin.SE3(begin.rotation, begin.translation + step) for step in circle]
    targets = stack_targets([pose_target(pose.translation, pose.rotation) for pose in poses])
    home = np.array(robot.home)
    drift = np.outer(np.sin(0.5 * turn), [0.4, 0.0, -0.4, 0.0, 0.0, 0.0, 0.0])
    q = np.clip(home + drift, arm.lower, arm.upper)
    left, _ = project_onto_targets(arm.chain, targets, q, arm.lower, arm.upper)
    assert left.max() <= 1e-9
    cost = plain_cost(arm.dof)
    at_once, _ = shortened(arm, targets, q, home, cost)
    coarse, _ = shortened_coarse_first(arm, targets, q, home, cost)
    distance, angle = errors_at(arm.chain, targets, coarse)
    assert max(distance.max(), angle.max()) <= 1e-9
    assert (coarse >= arm.lower).all()
    assert (coarse <= arm.upper).all()
    lengths = [sequence_cost(rows, home, False, cost) for rows in (q, at_once, coarse)]
    assert lengths[2] <= lengths[1] * (1.0 + 1e-4)
    assert lengths[2] < lengths[0]


def test_a_start_chosen_by_few_points_leads_to_no_more_motion_than_one_chosen_by_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Along a serpentine of 135 half circles."""
    down = [1.0, 0.0, 0.0, 0.0]
    rows: list[dict[str, Any]] = []
    for row in range(3):
        y = 0.03 * row
        at = {"position": [0.25, y, 0.1], "quaternion_xyzw": down}
        rows += [{"type": "line", "to": at}] if row else []
        rows += [
            {"type": "arc", "centre": [0.254 + 0.008 * k, y, 0.1], "angle": (-1) ** k * math.pi}
            for k in range(45)
        ]
    begin = {"position": [0.25, 0.0, 0.1], "quaternion_xyzw": down}
    path = {"begin": begin, "segments": rows}
    request = {"robot": "xarm7", "start": "free", "path": path, "budget_s": 300}
    plan = ikplan.plan(request)
    monkeypatch.setattr(path_tracker, "LONG", 10**9)
    at_all = ikplan.plan(request)
    assert plan.certificate.valid
    moved, moved_at_all = (
        float(np.linalg.norm(np.diff(p.q, axis=0), axis=1).sum()) for p in (plan, at_all)
    )
    assert moved <= moved_at_all
