"""Long paths are led through a few of their points first, which changes no plan for the worse."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from benchmarks.golden.cases import golden_cases
from ikplan import load_robot
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.ladder.motion_cost import plain_cost, sequence_cost
from ikplan.planning.tracking import start_tracker
from ikplan.planning.tracking.coarse_shortening import shortened, shortened_coarse_first
from ikplan.planning.tracking.tracking_kernels import errors_at, project_onto_targets
from ikplan.planning.waypoints.stack import stack_targets

DOWN = [1.0, 0.0, 0.0, 0.0]


def moved(plan: ikplan.Plan) -> float:
    """Joint motion of a plan [rad]."""
    return float(np.linalg.norm(np.diff(plan.q, axis=0), axis=1).sum())


def line_of(robot: str, begin: list[float], count: int) -> ikplan.Plan:
    """A plan of one straight line in many parts."""
    points = np.linspace(begin, np.add(begin, [0.2, 0.05, 0.03]), count)
    waypoints = [{"position": p.tolist(), "quaternion_xyzw": DOWN} for p in points]
    return ikplan.plan(
        {
            "robot": robot,
            "start": "free",
            "path": {"interpolation": "line", "waypoints": waypoints},
            "limits": {"jerk": False},
            "budget_s": 300,
        }
    )


@pytest.mark.parametrize(
    ("robot", "begin"),
    [
        ("xarm7", [0.3, -0.025, 0.285]),
        ("iiwa14", [0.4, 0.075, 0.485]),
        ("panda", [0.35, -0.025, 0.385]),
    ],
)
def test_a_line_in_many_parts_moves_the_joints_no_more_than_in_few(
    robot: str, begin: list[float]
) -> None:
    """In 1,500 parts the line of the xArm moved its joints by 16 rad once, in two by 0.93."""
    few, many = line_of(robot, begin, 12), line_of(robot, begin, 400)
    assert moved(many) <= 1.01 * moved(few)
    assert many.duration <= 1.02 * few.duration


@pytest.mark.parametrize(
    ("robot", "start", "goal", "slower"),
    [
        (
            "xarm7",
            [1.63197, -1.51076, -0.9964, 1.03661, -2.90873, -0.55728, 5.98087],
            [0.2255, 0.1077, 0.4556, -0.10999, 0.57964, 0.71742, 0.37044],
            1.05,
        ),
        (
            "iiwa14",
            [-1.09081, 2.02793, 0.11782, 1.76777, 1.67008, -1.59607, -1.73496],
            [0.09701, -0.50096, 0.25516, 0.66422, -0.42322, -0.44081, 0.43057],
            1.2,
        ),
    ],
)
def test_a_line_in_many_parts_that_begins_near_limits_is_moved_along_as_in_one(
    robot: str, start: list[float], goal: list[float], slower: float
) -> None:
    """Each of 300 parts added to the self-motion away from a limit: 2.6 rad of the xArm for 0.67.

    That of the iiwa, at a limit on a part of the line, had kinks: 1.35 s for 0.92.
    """
    begin, end = load_robot(robot).fk(np.array(start)), pin.XYZQUATToSE3(np.array(goal))
    turn = pin.log3(begin.rotation.T @ end.rotation)
    plans = []
    for parts in (1, 300):
        waypoints = []
        for share in np.linspace(0.0, 1.0, parts + 1)[1:]:
            p = begin.translation + share * (end.translation - begin.translation)
            R = pin.Quaternion(begin.rotation @ pin.exp3(share * turn))
            waypoints.append({"position": p.tolist(), "quaternion_xyzw": R.coeffs().tolist()})
        path = {"interpolation": "line", "waypoints": waypoints}
        plans.append(ikplan.plan({"robot": robot, "start": start, "path": path}))
    motion = [float(np.linalg.norm(np.diff(x.trajectory.q, axis=0), axis=1).sum()) for x in plans]
    assert motion[1] <= 1.02 * motion[0]
    assert plans[1].duration <= slower * plans[0].duration


def test_a_start_chosen_by_few_points_leads_to_no_more_motion_than_one_chosen_by_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Along a serpentine of 135 half circles."""
    rows: list[dict[str, Any]] = []
    for row in range(3):
        y = 0.03 * row
        at = {"position": [0.25, y, 0.1], "quaternion_xyzw": DOWN}
        rows += [{"type": "line", "to": at}] if row else []
        rows += [
            {"type": "arc", "centre": [0.254 + 0.008 * k, y, 0.1], "angle": (-1) ** k * math.pi}
            for k in range(45)
        ]
    begin = {"position": [0.25, 0.0, 0.1], "quaternion_xyzw": DOWN}
    path = {"begin": begin, "segments": rows}
    request = {"robot": "xarm7", "start": "free", "path": path, "budget_s": 300}
    plan = ikplan.plan(request)
    monkeypatch.setattr(start_tracker, "LONG", 10**9)
    at_all = ikplan.plan(request)
    assert plan.certificate.valid
    assert moved(plan) <= moved(at_all)


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


def test_a_zigzag_that_few_points_do_not_stand_for_is_led_through_all() -> None:
    """A sawtooth of 26 teeth, free in orientation: 18.8 rad led by few points, 14.7 by all."""
    cases = {name: request for name, _, request in golden_cases()}
    plan = ikplan.plan(cases["random/curve/14"])
    assert moved(plan) < 14.8
