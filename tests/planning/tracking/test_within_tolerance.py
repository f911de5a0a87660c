"""Paths that cannot be tracked exactly, or only by a flip: led within the tolerance, certified."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from benchmarks.planning import singular
from ikplan import Plan, Robot, load_robot
from tests.measured import off_polyline

from ..planar import REACH, joints, two_links

QUIET = {"self_collision": False}
POSITION, ORIENTATION = singular.POSITION, singular.ORIENTATION


def check_deviation(plan: Plan, robot: Robot, request: dict[str, Any]) -> float:
    """The line is kept within the tolerance, by Pinocchio; the largest deviation [tolerances]."""
    end = request["path"]["segments"][0]["to"]
    T = robot.fk(np.array(request["start"]))
    times = np.linspace(0.0, plan.duration, 2001)
    q = np.array([plan.at(float(t))[0] for t in times])
    R, p = robot.poses(q)
    off = off_polyline(p, [T.translation, np.array(end["position"])]).max() / POSITION
    turn = max(np.linalg.norm(pin.log3(T.rotation.T @ r)) for r in R) / ORIENTATION
    assert off <= 1.0
    assert turn <= 1.0
    assert (plan.certificate.max_path_deviation or 0.0) <= POSITION
    assert (plan.certificate.max_orientation_deviation or 0.0) <= ORIENTATION
    return float(max(off, turn))


AIMED = [
    ("ur5", 27),
    ("ur5", 37),
    ("panda", 11),
    ("panda", 47),
    ("iiwa14", 10),
    ("iiwa14", 11),
]
"""Arms, and seeds whose first line the judge passes."""


@pytest.mark.parametrize(("name", "seed"), AIMED)
def test_lines_that_a_damped_tracker_passes_are_planned(name: str, seed: int) -> None:
    robot = load_robot(name)
    line = singular.aimed_line(robot, np.random.default_rng(seed), steps=300)
    assert line is not None
    start, end, _ = line
    R = robot.fk(start).rotation
    assert singular.passes(robot, start, R, end, steps=300)
    request = singular.line_request(robot, start, R, end)
    check_deviation(ikplan.plan(request), robot, request)


def test_a_line_that_stays_beside_a_singularity_all_along_is_planned_without_swaying() -> None:
    start = [
        0.6892030674680734, -0.7209335961535716, 1.2209819440729996, -0.5005372979813976,
        0.004367254361064639, 1.347238590437158,
    ]  # fmt: skip
    robot = load_robot("ur5")
    R = robot.fk(np.array(start)).rotation
    end = np.array([0.32777341, 0.51112437, -0.04790958])
    request = singular.line_request(robot, np.array(start), R, end)
    plan = ikplan.plan(request)
    check_deviation(plan, robot, request)
    q = np.array([plan.at(float(t))[0] for t in np.linspace(0.0, plan.duration, 200)])
    # The wrist goes straight through; steps scattered by the singularity sway by 0.05 rad each.
    moved = np.abs(np.diff(q, axis=0)).sum(axis=0)
    assert (moved - np.abs(q[-1] - q[0])).max() < 0.02


def test_a_line_from_a_singular_wrist_across_it_is_planned_within_the_tolerance() -> None:
    """The wrist turns by 0.1 rad on the first of the way, 0.02 mm beside it."""
    start = np.array([0.3, -1.2, 1.5, -0.4, 0.0, 0.2])
    robot = load_robot("ur5")
    T = robot.fk(start)
    end = T.translation + np.array([0.0, 0.1, 0.0])
    request = singular.line_request(robot, start, T.rotation, end)
    assert check_deviation(ikplan.plan(request), robot, request) < 0.5
    request["path"]["tolerance"] = {"position": 1e-5, "orientation": 1e-4}
    with pytest.raises(ikplan.Disconnected, match="singular"):
        ikplan.plan(request)


def field_line(turn: float) -> dict[str, Any]:
    """A UR5 line whose tool is turned a little from where it meets the wrist's singularity."""
    start = [
        0.06315145819372611, -1.083063383852844, 1.4364425285417723, -3.494239105829305,
        0.13685149803514596, 1.8408668113445188,
    ]  # fmt: skip
    robot = load_robot("ur5")
    T = robot.fk(np.array(start))
    R = T.rotation @ pin.exp3(np.array([0.0, turn, 0.0]))
    begin = ikplan.solve_ik(robot, pin.SE3(R, T.translation), start=start)
    q = np.array(begin.q)
    end = np.array([0.5428771873867462, 0.3853905253761375, 0.4235151450778662])
    return singular.line_request(robot, q, robot.fk(q).rotation, end)


@pytest.mark.parametrize("turn", [0.0, 3e-4, 8e-4])
def test_a_line_just_beside_the_wrist_singularity_costs_no_flip(turn: float) -> None:
    request = field_line(turn)
    plan = ikplan.plan(request)
    robot = load_robot("ur5")
    used = check_deviation(plan, robot, request)
    assert used > 0.1  # that much it takes
    motion = np.linalg.norm(np.diff(plan.q, axis=0), axis=1).sum()
    assert motion < 1.0
    assert plan.duration < 0.5


def test_a_line_far_enough_from_the_singularity_is_tracked_exactly() -> None:
    request = field_line(0.2)
    plan = ikplan.plan(request)
    assert (plan.certificate.max_orientation_deviation or 0.0) <= 0.5 * ORIENTATION


def test_a_tolerance_too_small_to_go_straight_costs_the_flip_or_ends() -> None:
    request = field_line(8e-4)
    request["path"]["tolerance"] = {"position": 1e-5, "orientation": 1e-5}
    try:
        plan = ikplan.plan(request)
    except ikplan.Disconnected:
        return
    assert np.linalg.norm(np.diff(plan.q, axis=0), axis=1).sum() > 2.0
    assert (plan.certificate.max_orientation_deviation or 0.0) <= 1e-5


def beyond_reach(beyond: float) -> dict[str, Any]:
    """A line of the planar arm that ends beyond its reach."""
    start = joints([0.6, 0.0, 0.0], 1.0)
    end = {"position": [REACH + beyond, 0.0, 0.0]}
    return {
        "robot": "two",
        "start": [float(v) for v in start],
        "path": {"segments": [{"type": "line", "to": end}]},
        "limits": {"jerk": False},
    }


@pytest.mark.parametrize("beyond", [1e-9, 1e-6, 5e-5])
def test_a_line_that_ends_beyond_reach_by_less_than_the_tolerance_is_planned(
    beyond: float,
) -> None:
    plan = ikplan.plan(beyond_reach(beyond), robot=two_links())
    assert plan.waypoints.position_error[-1] == pytest.approx(beyond, abs=2e-5)
    assert (plan.certificate.max_path_deviation or 0.0) <= POSITION


def test_a_line_that_ends_beyond_reach_by_more_is_refused_and_says_by_how_much() -> None:
    with pytest.raises(ikplan.Unreachable) as caught:
        ikplan.plan(beyond_reach(2e-4), robot=two_links())
    assert caught.value.position_error == pytest.approx(2e-4, rel=1e-2)


@pytest.mark.parametrize("over", [1e-9, 2e-5])
def test_a_joint_limit_passed_by_a_hair_holds_nothing_up(over: float) -> None:
    """The shoulder would have to turn past its limit by less than the tolerance allows."""
    begin, end = joints([0.6, 0.3, 0.0], 1.0), joints([0.6, -0.3, 0.0], 1.0)
    lowest = float(end[0]) + over
    robot = two_links(shoulder=(lowest, 2.0))
    request = beyond_reach(0.0)
    request["start"] = [float(v) for v in begin]
    request["path"]["segments"][0]["to"]["position"] = [0.6, -0.3, 0.0]
    plan = ikplan.plan(request, robot=robot)
    assert plan.q[:, 0].min() >= lowest
    assert plan.waypoints.position_error[-1] <= POSITION
