"""Full turns at the begin of a tool path: of the copies that go through, the nearest one."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikplan
from ikplan.documents.poses import Tolerance
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.tracking.start_copies import (
    StartCopies,
    distinct_modulo_turns,
    turning_joints,
    without_limits,
)
from ikplan.planning.waypoints.ik_branches import branches, further_branches
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.robots import load_robot
from ikplan.time_budget import TimeBudget
from tests.planning.planar import solver_of

TURN = 2.0 * math.pi
UR5 = arm_of(load_robot("ur5"))
QUIET = {"self_collision": False}


def arc(robot: str, turns: float, **more: Any) -> dict[str, Any]:
    """A request for an arc of 100 mm across beside home, the tool turning with it."""
    T = load_robot(robot).fk(load_robot(robot).home)
    x, y, z, *quaternion = pin.SE3ToXYZQUAT(T).tolist()
    circle = {
        "type": "arc",
        "centre": [x - 0.05, y, z],
        "angle": turns * TURN,
        "orientation": "follow",
    }
    begin = {"position": [x, y, z], "quaternion_xyzw": quaternion}
    path = {"begin": begin, "segments": [circle]}
    return {"robot": robot, "start": "free", "path": path, "scene": QUIET, **more}


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), spread=st.floats(0.1, 11.0), counted=st.booleans())
def test_the_copy_is_the_nearest_of_those_that_fit(seed: int, spread: float, counted: bool) -> None:
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.0, 1.0, 6) + np.cumsum(rng.uniform(-0.1, 0.1, (30, 6)), axis=0)
    q[:, 5] = rng.uniform(-3.0, 3.0) + np.linspace(0.0, rng.choice([-1.0, 1.0]) * spread, 30)
    near = rng.uniform(-3.0, 3.0, 6)
    arm = replace(UR5, lower=np.full(6, -TURN), upper=np.full(6, TURN))
    copy, fits = StartCopies(near, counted).fitting(arm, q)

    shifts = [TURN * k for k in range(-3, 4)]
    best = None
    for j in range(6):
        inside = [x for x in shifts if np.abs(q[:, j] + x).max() <= TURN]
        if not inside:
            best = np.inf
            break
        step = min(abs(q[0, j] + x - near[j]) for x in inside)
        best = (best or 0.0) + step**2
    assert best is not None
    assert fits == math.isfinite(best)
    if fits:
        assert np.sum((copy[0] - near) ** 2) == pytest.approx(best, abs=1e-9)
        assert (np.abs(copy) <= TURN).all()
    np.testing.assert_allclose(np.diff(copy, axis=0), np.diff(q, axis=0), atol=1e-9)
    turns = (copy - q) / TURN
    np.testing.assert_allclose(turns, np.round(turns[:1]) + 0.0 * turns, atol=1e-9)
    assert StartCopies(near, counted).cost(copy[0]) == pytest.approx(
        np.linalg.norm(copy[0] - near) if counted else 0.0
    )


def test_where_no_copy_fits_it_is_the_one_that_fits_for_longest() -> None:
    arm = replace(UR5, lower=np.full(6, -TURN), upper=np.full(6, TURN))
    q = np.zeros((141, 6))
    q[:, 5] = np.linspace(0.0, 14.0, 141)  # more than the 4 pi there are
    copy, fits = StartCopies(np.zeros(6), counted=True).fitting(arm, q)
    assert not fits
    assert copy[0, 5] == pytest.approx(-TURN)


def test_copies_are_told_from_branches() -> None:
    rows = np.array(
        [
            [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
            [0.1, 0.2, 0.3, 0.4 + TURN, 0.5, 0.6],
            [0.1, 0.2, 0.3, 0.4, 0.5 - TURN, 0.6 + TURN],
            [0.1, 0.2, -0.3, 0.4, 0.5, 0.6],
        ]
    )
    np.testing.assert_array_equal(distinct_modulo_turns(UR5, rows), rows[[0, 3]])


def test_only_joints_with_room_for_a_turn_lose_their_limits() -> None:
    arm = arm_of(load_robot("xarm7"))
    turns = turning_joints(arm)
    free = without_limits(arm)
    np.testing.assert_array_equal(turns, np.array(arm.upper - arm.lower) >= TURN)
    assert 0 < turns.sum() < arm.dof
    np.testing.assert_array_equal(free.lower[~turns], arm.lower[~turns])
    assert np.isinf(free.upper[turns]).all()


@pytest.mark.parametrize("turns", [1.7, 1.9, -1.9])
@pytest.mark.parametrize("start", ["free", "home"])
def test_an_arc_of_nearly_two_turns_is_planned_from_the_copy_that_goes_through(
    turns: float, start: str
) -> None:
    request = arc("ur5", turns)
    if start == "home":
        request["start"] = load_robot("ur5").home.tolist()
        request["path"]["approach"] = "joint"
    plan = ikplan.plan(request)
    wound = np.abs(plan.q[-1] - plan.waypoints.q[-2]).max()
    assert wound == pytest.approx(abs(turns) * TURN, abs=0.5)
    robot = load_robot("ur5")
    assert ((robot.lower <= plan.q) & (plan.q <= robot.upper)).all()


@pytest.mark.parametrize("robot", ["ur10", "xarm7"])
def test_arcs_go_through_from_any_copy_of_other_arms(robot: str) -> None:
    plan = ikplan.plan(arc(robot, 1.7))
    assert np.ptp(plan.q, axis=0).max() > TURN


def test_an_arc_longer_than_all_the_turns_there_are_is_refused() -> None:
    with pytest.raises(ikplan.Disconnected) as caught:
        ikplan.plan(arc("ur5", 2.3))
    assert "limit" in caught.value.reason
    assert "waypoint -1" not in str(caught.value)


def test_a_free_start_is_the_copy_and_the_branch_nearest_to_home() -> None:
    robot = load_robot("ur5")
    waypoint = {"position": [0.4, 0.2, 0.5], "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0]}
    request = {"robot": "ur5", "start": "free", "path": {"waypoints": [waypoint]}, "scene": QUIET}
    q = ikplan.plan(request).q[0]
    home = np.array(robot.home)
    for j, turn in itertools.product(range(6), (-TURN, TURN)):
        other = q.copy()
        other[j] += turn
        if robot.lower[j] <= other[j] <= robot.upper[j]:
            assert np.linalg.norm(q - home) <= np.linalg.norm(other - home) + 1e-9
    assert np.abs(q - home).max() <= math.pi


@pytest.mark.parametrize("seed", range(4))
def test_a_free_start_of_a_motion_could_not_be_a_turn_nearer_to_home(seed: int) -> None:
    robot, rng = load_robot("ur5"), np.random.default_rng(seed)
    begin = rng.uniform(-2.0, 2.0, 6)
    poses = [pin.SE3ToXYZQUAT(robot.fk(begin + 0.05 * k)).tolist() for k in range(3)]
    waypoints = [{"position": p[:3], "quaternion_xyzw": p[3:]} for p in poses]
    for kind in ("joint", "line"):
        path = {"waypoints": waypoints, "interpolation": kind}
        plan = ikplan.plan({"robot": "ur5", "start": "free", "path": path, "scene": QUIET})
        home = np.array(robot.home)
        for j, turn in itertools.product(range(6), (-TURN, TURN)):
            moved = plan.q[:, j] + turn
            if (robot.lower[j] <= moved).all() and (moved <= robot.upper[j]).all():
                assert abs(plan.q[0, j] - home[j]) <= abs(moved[0] - home[j]) + 1e-9


def test_a_redundant_arm_begins_where_its_joints_have_the_range_for_the_whole_turn() -> None:
    """Of the starts tried first none has: 7.26 rad about the flange are beyond A1 or A7."""
    robot = load_robot("iiwa14")
    q = [1.26190997, -0.40777144, -1.63637987, -2.05388097, -0.46478294, -0.14375344, -0.57461279]
    T = robot.fk(q)
    x, y, z, *quaternion = pin.SE3ToXYZQUAT(T).tolist()
    circle = {
        "type": "arc",
        "centre": (T.translation - 0.01304 * T.rotation[:, 0]).tolist(),
        "axis": T.rotation[:, 2].tolist(),
        "angle": 7.2577,
        "orientation": "follow",
    }
    begin = {"position": [x, y, z], "quaternion_xyzw": quaternion}
    request = {
        "robot": "iiwa14",
        "start": "free",
        "path": {"begin": begin, "segments": [circle]},
        "scene": QUIET,
    }
    plan = ikplan.plan(request)
    assert plan.certificate.valid
    turned = robot.fk(plan.q[-1]).rotation @ T.rotation.T
    np.testing.assert_allclose(turned @ T.rotation[:, 2], T.rotation[:, 2], atol=1e-8)


def test_further_starts_are_solutions_far_from_those_tried() -> None:
    robot = load_robot("iiwa14")
    problem = WaypointProblem(
        robot,
        solver_of(robot),
        [pose_target(robot.fk(robot.home).translation, robot.fk(robot.home).rotation)],
        robot.home,
        True,
        Tolerance(),
        TimeBudget(60.0),
    )
    tried = branches(problem)
    further = further_branches(problem, tried)
    assert 24 < len(further) <= 48
    for k, q in enumerate(further):
        before = np.vstack([tried, further[:k]])
        assert np.abs(before - q).max(axis=1).min() > 1e-6
        T = robot.fk(q)
        np.testing.assert_allclose(T.homogeneous, robot.fk(robot.home).homogeneous, atol=1e-8)
