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
from ikplan.pipeline.pose_batch.request import solve_ik_batch_request, solve_ik_requests
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


def test_a_pose_takes_the_branch_that_is_preferred_from_home_and_near_a_start() -> None:
    """Every branch of the closed form is found by asking for it, or by a strong pull."""
    ur5 = UR5
    T = ur5.fk([0.3, -1.2, 1.4, -1.8, -1.57, 0.4])
    for elbow in (1.0, -1.0):
        for wrist in (1.0, -1.0):
            wanted = np.array([0.4, -1.1 if elbow > 0 else -0.2, 1.3 * elbow, -1.2, wrist, 0.3])
            posture = {"q": wanted.tolist()}
            found = ikplan.solve_ik(ur5, T, method="lm", posture=posture)
            assert np.sign(found.q[2]) == elbow
            assert np.linalg.norm(pin.log6(ur5.fk(found.q).actInv(T)).vector) < 1e-6
            assert found.posture is not None
            assert found.posture.mean_distance == pytest.approx(np.linalg.norm(found.q - wanted))
            near = ikplan.solve_ik(
                ur5, T, start=ur5.home, method="lm", posture={**posture, "pull": 50.0}
            )
            assert np.abs(near.q - found.q).max() < 1e-6


def test_a_pose_near_a_start_weighs_the_way_against_the_posture() -> None:
    """Self-motion of the panda: the cost is least on the circle of its elbow, by dense search."""
    q = np.array(PANDA.home)
    T = PANDA.fk(q)
    wanted = q + np.array([0.5, 0.0, -0.5, 0.0, 0.3, 0.0, 0.0])
    weights = np.array([1.0, 2.0, 0.5, 1.0, 1.0, 0.3, 1.0])
    for pull in (0.0, 0.5, 3.0):
        posture = {"q": wanted.tolist(), "weights": weights.tolist(), "pull": pull}
        found = ikplan.solve_ik(PANDA, T, start=q, method="lm", posture=posture).q

        def cost(row: Any, pull: float = pull) -> float:
            away = [np.linalg.norm(weights * (row - to)) for to in (q, wanted)]
            return float(away[0] + pull * away[1])

        others = [
            ikplan.solve_ik(PANDA, T, start=q + share * (wanted - q), method="lm").q
            for share in np.linspace(0.0, 1.0, 11)
        ]
        assert cost(found) <= min(map(cost, others)) + 1e-6
    assert cost(found) < cost(q)


def test_soft_limits_of_a_pose_are_kept_where_a_solution_is_within_and_told_where_not() -> None:
    ur5 = UR5
    T = ur5.fk([0.3, -1.2, 1.4, -1.8, -1.57, 0.4])
    pose = {
        "robot": "ur5",
        "position": T.translation.tolist(),
        "quaternion_xyzw": pin.Quaternion(T.rotation).coeffs().tolist(),
    }
    low = [-7.0, -7.0, -7.0, -7.0, -7.0, -7.0]
    high = [7.0, 7.0, 0.0, 7.0, 7.0, 7.0]
    posture: dict[str, Any] = {"lower": low, "upper": high}
    kept = solve_ik_request({**pose, "ik": {"posture": posture}})
    assert kept.q[2] <= 1e-9
    assert kept.posture is not None
    assert kept.posture.soft_limits_kept
    posture["lower"] = [-7.0, -7.0, -0.1, -7.0, -7.0, -7.0]
    left = solve_ik_request({**pose, "ik": {"posture": posture}})
    assert left.posture is not None
    assert list(left.posture.outside) == [ur5.joint_names[2]]
    assert left.position_error < 1e-6


def test_a_posture_of_a_pose_keeps_clear_of_the_arm_itself() -> None:
    ur5 = UR5
    T = ur5.fk([0.3, -1.2, 1.4, -1.8, -1.57, 0.4])
    for elbow in (1.3, -1.3):
        posture = {"q": [0.4, -1.1, elbow, -1.2, -1.4, 0.3]}
        found = ikplan.solve_ik(ur5, T, scene={}, posture=posture)
        assert ur5.clearance(found.q).distance > 0.0
        assert np.sign(found.q[2]) == np.sign(elbow)


def test_a_posture_where_nothing_is_chosen_is_refused() -> None:
    pose = {"robot": "ur5", "position": [0.4, 0.1, 0.4]}
    ik = {"posture": {"q": [0.0] * 6}}
    with pytest.raises(InvalidRequest, match="refine"):
        solve_ik_request({**pose, "ik": {**ik, "refine": False}})
    batch = {"robot": "ur5", "poses": [{"position": [0.4, 0.1, 0.4]}], "ik": ik}
    with pytest.raises(InvalidRequest, match="batches"):
        solve_ik_batch_request(batch)
    with pytest.raises(InvalidRequest, match="6 "):
        solve_ik_request({**pose, "ik": {"posture": {"weights": [1.0] * 5}}})


def test_poses_of_a_batch_of_requests_keep_their_postures() -> None:
    pose = {"robot": "ur5", "position": [0.4, 0.1, 0.4]}
    each = [
        {**pose, "ik": {"method": "lm", "posture": {"q": [0.4, -1.0, elbow, 0.0, 0.0, 0.0]}}}
        for elbow in (1.3, -1.3)
    ]
    for request, answer in zip(each, solve_ik_requests([*each, pose]), strict=False):
        assert not isinstance(answer, Exception)
        assert answer.q == pytest.approx(solve_ik_request(request).q, abs=0.0)


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
