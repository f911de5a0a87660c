"""The posture that a request prefers: branches, self-motion, soft limits, weights, ids."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import InvalidRequest, load_robot
from ikplan.documents.plan_request import PlanRequest
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.pipeline.poses import solve_ik_request
from ikplan.planning.ladder.motion_cost import (
    MotionCost,
    plain_cost,
    posture_distance,
    turned_posture_distance,
)
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.planning.ladder.shortest_sequences import ik_candidates
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.time_budget import TimeBudget

UR5 = load_robot("ur5")
PANDA = load_robot("panda")


def waypoint(robot: Any, q: Any) -> dict[str, Any]:
    T = robot.fk(q)
    quaternion = pin.Quaternion(T.rotation).normalized().coeffs()
    return {"position": T.translation.tolist(), "quaternion_xyzw": quaternion.tolist()}


def request(robot: str, path: dict[str, Any], posture: Any = None, **more: Any) -> dict[str, Any]:
    asked = {"robot": robot, "path": path, "scene": {"self_collision": False}, **more}
    return asked if posture is None else {**asked, "ik": {"posture": posture}}


def test_a_request_without_a_posture_keeps_its_id() -> None:
    plain = request("ur5", {"waypoints": [{"position": [0.4, 0.1, 0.4]}]})
    ids = [
        PlanRequest.model_validate({**plain, "ik": ik}).content_hash()
        for ik in ({}, {"posture": None}, {"posture": {"q": [0.0] * 6}})
    ]
    assert ids[0] == ids[1] != ids[2]


@pytest.mark.parametrize("elbow", [1.0, -1.0])
@pytest.mark.parametrize("interpolation", ["joint", "line"])
def test_a_free_start_takes_the_branch_that_is_preferred(elbow: float, interpolation: str) -> None:
    wanted = np.array([0.4, -1.1 if elbow > 0 else -0.2, 1.3 * elbow, -1.2, -1.4, 0.3])
    begin = waypoint(UR5, wanted)
    end = {**begin, "position": np.add(begin["position"], [0.0, 0.0, 0.05]).tolist()}
    path = {"waypoints": [begin, end], "interpolation": interpolation}
    plan = ikplan.plan(request("ur5", path, {"q": wanted.tolist()}, start="free"))
    assert plan.q[0] == pytest.approx(wanted, abs=1e-5)
    assert plan.posture is not None
    assert plan.posture.mean_distance is not None
    assert plan.posture.mean_distance < 0.5


def test_a_start_that_is_given_leaves_the_branch_where_that_is_worth_it() -> None:
    """The elbow goes to the preferred side where the pull is worth the way there, else not."""
    q = np.array([0.4, -1.1, 1.3, -1.2, -1.4, 0.3])
    path = {"waypoints": [waypoint(UR5, q + 0.05 * k) for k in (1, 2, 3)]}
    home = ikplan.plan(request("ur5", path, start=q.tolist()))
    other = q.copy()
    other[1:4] = q[1] + 1.2, -1.3, q[3] + 1.4
    sides = []
    for pull in (0.1, 10.0):
        posture = {"q": other.tolist(), "pull": pull}
        plan = ikplan.plan(request("ur5", path, posture, start=q.tolist()))
        sides.append(np.sign(plan.waypoints.q[-1, 2]))
    assert home.waypoints.q[-1, 2] > 0
    assert sides == [1.0, -1.0]


def test_self_motion_goes_towards_the_preferred_configuration() -> None:
    q = np.array(PANDA.home)
    end = np.add(PANDA.fk(q).translation, [0.0, 0.15, -0.05]).tolist()
    path = {"segments": [{"type": "line", "to": {**waypoint(PANDA, q), "position": end}}]}
    aside = q.copy()
    aside[0] += 0.8
    away = []
    for pull in (0.0, 1.0, 20.0):
        posture = {"q": aside.tolist(), "pull": pull}
        plan = ikplan.plan(request("panda", path, posture, start=q.tolist()))
        away.append(float(np.linalg.norm(plan.q[-1] - aside)))
    assert away[0] > away[1] + 1e-3 > away[2] + 1e-2


def test_a_joint_that_weighs_more_moves_less() -> None:
    q = np.array(PANDA.home)
    end = np.add(PANDA.fk(q).translation, [0.0, 0.3, 0.0]).tolist()
    path = {"segments": [{"type": "line", "to": {**waypoint(PANDA, q), "position": end}}]}
    moved = []
    for weight in (0.1, 1.0, 10.0):
        posture = {"weights": [weight, *[1.0] * 6]}
        plan = ikplan.plan(request("panda", path, posture, start=q.tolist()))
        moved.append(float(np.abs(np.diff(plan.q[:, 0])).sum()))
    assert moved[0] > moved[1] + 0.01 > moved[2] + 0.02


def test_soft_limits_are_kept_where_a_motion_within_is_found_and_told_where_not() -> None:
    q = np.array(PANDA.home)
    end = np.add(PANDA.fk(q).translation, [0.0, 0.3, 0.0]).tolist()
    path = {"segments": [{"type": "line", "to": {**waypoint(PANDA, q), "position": end}}]}
    plain = ikplan.plan(request("panda", path, start=q.tolist()))
    most = float(plain.q[:, 0].max())
    upper = PANDA.upper.copy()
    upper[0] = q[0] + 0.6 * (most - q[0])
    kept = ikplan.plan(request("panda", path, {"upper": upper.tolist()}, start=q.tolist()))
    assert plain.posture is None
    assert kept.posture is not None
    assert kept.posture.soft_limits_kept
    assert kept.q[:, 0].max() <= upper[0] + 1e-9
    upper[:] = q + 1e-3  # every joint: the line cannot be followed so
    lower = q - 1e-3
    tight = {"lower": lower.tolist(), "upper": upper.tolist()}
    left = ikplan.plan(request("panda", path, tight, start=q.tolist()))
    assert left.posture is not None
    assert left.posture.soft_limits_kept is False
    assert left.posture.outside
    past = np.maximum(left.q - upper, lower - left.q).max(axis=0)
    for name, by in left.posture.outside.items():
        assert by == pytest.approx(past[PANDA.joint_names.index(name)], rel=1e-9)


def test_values_that_the_request_gives_count_as_inside_the_soft_limits() -> None:
    q = np.array(PANDA.home)
    path = {"segments": [{"type": "joint", "q": (q + 0.3).tolist()}]}
    posture = {"lower": (q + 0.1).tolist(), "upper": (q + 0.2).tolist()}
    plan = ikplan.plan(request("panda", path, posture, start=q.tolist()))
    assert plan.q[-1] == pytest.approx(q + 0.3, abs=1e-9)


@pytest.mark.parametrize(
    ("posture", "field"),
    [
        ({"q": [0.0] * 5}, "ik.posture.q"),
        ({"q": [7.0] * 6}, "ik.posture.q[0]"),
        ({"weights": [1.0] * 5}, "ik.posture.weights"),
        ({"weights": [0.0] * 6}, "ik.posture.weights[0]"),
        ({"lower": [0.5] * 6, "upper": [0.4] * 6}, "ik.posture.lower"),
        ({}, "ik.posture"),
    ],
)
def test_a_posture_that_makes_no_sense_is_refused(posture: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidRequest) as refused:
        ikplan.plan(request("ur5", {"waypoints": [waypoint(UR5, UR5.home)]}, posture))
    assert refused.value.field == field


def test_a_posture_of_a_single_pose_is_refused() -> None:
    with pytest.raises(InvalidRequest, match="start"):
        solve_ik_request(
            {"robot": "ur5", "position": [0.4, 0.1, 0.4], "ik": {"posture": {"q": [0.0] * 6}}}
        )


def test_the_distance_over_turns_is_the_least_of_all_copies() -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        lower = rng.uniform(-8.0, 8.0, 2)
        upper = lower + rng.choice([0.0, 1.0, 5.0, 7.0], 2)
        cost = MotionCost(rng.uniform(0.1, 3.0, 2), lower, upper, 1.0)
        q = rng.uniform(-9.0, 9.0, 2)
        turns = rng.random(2) < 0.6
        copies = [
            q[d] + 2.0 * np.pi * np.arange(-4, 5) if turns[d] else q[d : d + 1] for d in range(2)
        ]
        least = min(posture_distance(np.array(c), cost) for c in itertools.product(*copies))
        assert turned_posture_distance(q, turns, cost) == pytest.approx(least, abs=1e-12)


@pytest.mark.parametrize("ranges", [0.0, 0.1])
def test_shortening_ends_where_no_self_motion_lowers_the_cost(ranges: float) -> None:
    """Against small steps along each waypoint's self-motion, taken back onto the target."""
    arm, rng = arm_of(PANDA), np.random.default_rng(3)
    home = np.array(PANDA.home)
    targets = []
    for k in range(4):
        T = PANDA.fk(home + 0.1 * (k + 1))
        targets.append(pose_target(T.translation, T.rotation))
    stacked = stack_targets(targets)
    found = ik_candidates(arm, stacked, home, TimeBudget(1e6))
    q = np.ascontiguousarray(found.q[:, 0])
    aside = home + rng.uniform(-0.5, 0.5, 7)
    cost = MotionCost(rng.uniform(0.5, 2.0, 7), aside - ranges, aside + ranges, 2.0)
    best, _ = shorten_sequence(
        arm.chain, stacked, q, home, False, arm.lower, arm.upper, cost, 200, 1e-12
    )
    assert best == pytest.approx(_cost(q, home, cost), rel=1e-12)
    for k in range(4):
        J = PANDA.jacobian(q[k])
        null = np.linalg.svd(J)[2][-1]
        costs = []
        for step in (1e-3, -1e-3):
            moved = q.copy()
            moved[k] += step * null
            costs.append(_cost(moved, home, cost))
        assert abs(costs[0] - costs[1]) < 2e-3 * 2e-3


def _cost(q: Any, start: Any, cost: MotionCost) -> float:
    steps = cost.weights * np.diff(np.vstack([start, q]), axis=0)
    past = cost.weights * np.maximum(np.maximum(cost.lower - q, q - cost.upper), 0.0)
    mean = float(np.linalg.norm(past, axis=1).mean())
    return float(np.linalg.norm(steps, axis=1).sum() + cost.pull * mean)


def test_a_plain_cost_is_the_length() -> None:
    q = np.random.default_rng(1).uniform(-1.0, 1.0, (5, 6))
    assert posture_distance(q[0], plain_cost(6)) == 0.0
