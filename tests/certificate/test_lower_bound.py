"""The least elongation in closed form: what a miss takes off, and how far a joint reaches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from ikplan import load_robot
from ikplan.certificate import elongation
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedWaypoint
from ikplan.certificate.waypoints import Misses
from ikplan.documents.path import PathRequest
from ikplan.robots import Robot
from tests.kinematics.synthetic import Joint, robot_of

SLIDER = robot_of([Joint("prismatic", axis=(1, 0, 0))])
WHEEL = robot_of([Joint("revolute", axis=(0, 0, 1))])
EXACT: dict[str, Any] = {"rel": 3e-12, "abs": 0.0}
"""Nearer to the closed form than the rounding that the bound leaves room for, three times."""


def elongation_lower_bound(
    robot: Robot,
    q_start: np.ndarray | None,
    poses: Sequence[tuple[np.ndarray, np.ndarray | None]],
    misses: Sequence[tuple[float, float | None]],
    **allowed: Any,
) -> float:
    """The bound for waypoints given as position and orientation, each with what it is missed by."""
    asked = [RequestedWaypoint(p, R) for p, R in poses]
    path = PathRequest.model_validate({"waypoints": [{"position": [0.0, 0.0, 0.0]}], **allowed})
    missed = Misses(
        np.array([distance for distance, _ in misses]),
        np.array([angle or 0.0 for _, angle in misses]),
        np.array([R is not None for _, R in poses]),
        np.zeros(len(poses)),
    )
    return elongation.elongation_lower_bound(robot, q_start, asked, Allowance(path), missed)


def places(*x: float) -> list[tuple[np.ndarray, None]]:
    return [(np.array([value, 0.0, 0.0]), None) for value in x]


def turns(*angles: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """The same place, turned about z."""
    return [(np.zeros(3), pin.exp3(np.array([0.0, 0.0, angle]))) for angle in angles]


def test_the_misses_of_both_ends_are_taken_off_each_step() -> None:
    poses = places(1.0, 0.2, 2.0)
    misses = [(0.1, None), (0.25, None), (0.4, None)]
    steps = (1.0 - 0.1) + (0.8 - 0.1 - 0.25) + (1.8 - 0.25 - 0.4)
    found = elongation_lower_bound(SLIDER, np.zeros(1), poses, misses)
    assert found == pytest.approx(steps, **EXACT)


def test_the_misses_of_both_turns_are_taken_off_each_step() -> None:
    poses = turns(1.0, 0.2, 2.0)
    misses = [(0.0, 0.1), (0.0, 0.25), (0.0, 0.4)]
    steps = (1.0 - 0.1) + (0.8 - 0.1 - 0.25) + (1.8 - 0.25 - 0.4)
    found = elongation_lower_bound(WHEEL, np.zeros(1), poses, misses)
    assert found == pytest.approx(steps, **EXACT)


def test_a_plan_that_uses_its_tolerance_up_is_not_below_the_bound() -> None:
    """The slider stops short of the first place and the second: it moves by less than asked."""
    reached = np.array([[0.9], [0.45], [1.6]])
    wanted = np.array([1.0, 0.2, 2.0])
    misses = [(float(m), None) for m in np.abs(reached[:, 0] - wanted)]
    moved = float(np.abs(np.diff(np.vstack([[[0.0]], reached]), axis=0)).sum())
    found = elongation_lower_bound(SLIDER, np.zeros(1), places(*wanted), misses)
    assert found <= moved
    assert found == pytest.approx(moved, **EXACT)


def test_a_step_that_misses_more_than_it_moves_takes_nothing_off_the_others() -> None:
    misses = [(0.0, None), (5.0, None), (0.0, None)]
    found = elongation_lower_bound(SLIDER, np.zeros(1), places(1.0, 2.0, 3.0), misses)
    assert found == pytest.approx(1.0, **EXACT)
    missed_turns = [(0.0, 0.0), (0.0, 9.0), (0.0, 0.0)]
    found = elongation_lower_bound(WHEEL, np.zeros(1), turns(1.0, 2.0, 3.0), missed_turns)
    assert found == pytest.approx(1.0, **EXACT)


def test_with_a_free_start_it_begins_at_the_first_waypoint() -> None:
    misses = [(0.1, None), (0.2, None)]
    found = elongation_lower_bound(SLIDER, None, places(1.0, 2.0), misses)
    assert found == pytest.approx(1.0 - 0.1 - 0.2, **EXACT)
    found = elongation_lower_bound(WHEEL, None, turns(1.0, 2.0), [(0.0, 0.1), (0.0, 0.2)])
    assert found == pytest.approx(1.0 - 0.1 - 0.2, **EXACT)
    assert elongation_lower_bound(SLIDER, None, places(1.0), [(0.1, None)]) == 0.0


def test_a_turn_counts_only_between_two_orientations() -> None:
    poses = [turns(1.0)[0], (np.zeros(3), None), turns(2.0)[0]]
    misses = [(0.0, 0.0), (0.0, None), (0.0, 0.0)]
    found = elongation_lower_bound(WHEEL, np.zeros(1), poses, misses)
    assert found == pytest.approx(1.0, **EXACT)


def test_a_place_that_no_joint_can_move_the_tool_to_asks_for_no_motion() -> None:
    assert elongation_lower_bound(WHEEL, np.zeros(1), places(1.0), [(0.0, None)]) == 0.0
    assert elongation_lower_bound(SLIDER, np.zeros(1), turns(1.0), [(0.0, 0.0)]) == 0.0


def reach_of(robot: Robot, metres: float = 0.125) -> float:
    """What the bound takes the joints to move the tool by, over their motion [m/rad]."""
    q = robot.clip(np.zeros(robot.dof))
    pose = (robot.fk(q).translation + np.array([metres, 0.0, 0.0]), None)
    return metres / elongation_lower_bound(robot, q, [pose], [(0.0, None)])


def arm(*joints: Joint, tip: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Robot:
    return robot_of(joints, tip=Joint("fixed", xyz=tip))


def test_a_turning_joint_reaches_over_all_links_after_it() -> None:
    shoulder = Joint("revolute", xyz=(0.0, 0.0, 7.0))  # the pedestal is before it
    elbow = Joint("revolute", xyz=(0.3, 0.0, 0.4))
    wrist = Joint("continuous", xyz=(0.0, 0.25, 0.0))
    robot = arm(shoulder, elbow, wrist, tip=(0.0, 0.0, 0.125))
    reaches = [0.5 + 0.25 + 0.125, 0.25 + 0.125, 0.125]
    assert reach_of(robot) == pytest.approx(math.hypot(*reaches), **EXACT)
    # A tool makes the last link longer, in whatever direction.
    tool = robot.with_tool([0.0, 3.0, 0.0])
    last = math.hypot(3.0, 0.125)
    reaches = [0.75 + last, 0.25 + last, last]
    assert reach_of(tool) == pytest.approx(math.hypot(*reaches), **EXACT)


@pytest.mark.parametrize(("lower", "upper"), [(-0.25, 1.5), (-1.5, 0.25), (0.5, 1.5)])
def test_a_slide_reaches_by_itself_and_lengthens_the_arm_of_the_joints_before_it(
    lower: float, upper: float
) -> None:
    turn = Joint("continuous")
    slide = Joint("prismatic", axis=(1, 0, 0), xyz=(0.25, 0.0, 0.0), lower=lower, upper=upper)
    hand = Joint("revolute", xyz=(0.0, 0.125, 0.0))
    robot = arm(turn, slide, hand, tip=(0.0, 0.0, 0.5))
    reaches = [0.25 + 1.5 + 0.125 + 0.5, 1.0, 0.5]
    assert reach_of(robot) == pytest.approx(math.hypot(*reaches), **EXACT)


def test_two_slides_both_lengthen_the_arm_before_them() -> None:
    robot = arm(
        Joint("revolute"),
        Joint("prismatic", axis=(1, 0, 0), lower=0.0, upper=0.5),
        Joint("prismatic", axis=(1, 0, 0), lower=0.0, upper=0.25),
    )
    assert reach_of(robot) == pytest.approx(math.hypot(0.75, 1.0, 1.0), **EXACT)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_parallel_joints_share_a_turn_and_slides_have_no_part_in_it(count: int) -> None:
    wheels = [Joint("revolute", axis=(0, 0, 1)) for _ in range(count)]
    slide = Joint("prismatic", axis=(0, 0, 1))
    for joints in (wheels, [slide, *wheels], [*wheels, slide, slide]):
        robot = robot_of(joints)
        start = np.zeros(robot.dof)
        found = elongation_lower_bound(robot, start, turns(0.5), [(0.0, 0.0)])
        assert found == pytest.approx(0.5 / math.sqrt(count), **EXACT)


def test_a_coupled_joint_reaches_with_every_joint_that_follows_it() -> None:
    robot = load_robot("dobot_magician")
    model = robot.model
    T_tip_tool = model.frames[robot.tip_frame_id].placement * robot.T_tip_tool
    links = [np.linalg.norm(model.jointPlacements[j].translation) for j in range(2, model.njoints)]
    links.append(np.linalg.norm(T_tip_tool.translation))
    serial = np.array([sum(links[k:]) for k in range(model.nv)])
    each = [sum(abs(robot.coupling[k, j]) * serial[k] for k in range(model.nv)) for j in range(4)]
    assert reach_of(robot) == pytest.approx(math.hypot(*each), **EXACT)
    most = float(np.linalg.svd(robot.coupling)[1][0]) * math.sqrt(model.nv)
    q = np.array(robot.home)
    T = robot.fk(q)
    pose = (T.translation, T.rotation @ pin.exp3(np.array([0.0, 0.0, 0.5])))
    found = elongation_lower_bound(robot, q, [pose], [(0.0, 0.0)])
    assert found == pytest.approx(0.5 / most, rel=1e-9)


def test_the_larger_of_what_moving_and_turning_need_counts() -> None:
    robot = robot_of([Joint("prismatic", axis=(0, 0, 1)), Joint("revolute", axis=(0, 0, 1))])
    for height, angle in ((0.5, 0.25), (0.25, 0.5)):
        pose = (np.array([0.0, 0.0, height]), pin.exp3(np.array([0.0, 0.0, angle])))
        found = elongation_lower_bound(robot, np.zeros(2), [pose], [(0.0, 0.0)])
        assert found == pytest.approx(0.5, **EXACT)


def test_a_box_allows_half_its_diagonal_at_each_end_but_the_start() -> None:
    tolerance = {"box": {"position": [0.03, 0.04, 0.12], "orientation": [0.02, 0.06, 0.09]}}
    exact = [(0.0, 0.0)] * 2
    found = elongation_lower_bound(
        SLIDER, np.zeros(1), places(1.0, 3.0), [(0.0, None)] * 2, tolerance=tolerance
    )
    assert found == pytest.approx((1.0 - 0.13) + (2.0 - 0.26), **EXACT)
    found = elongation_lower_bound(WHEEL, np.zeros(1), turns(1.0, 2.5), exact, tolerance=tolerance)
    assert found == pytest.approx((1.0 - 0.11) + (1.5 - 0.22), **EXACT)
    found = elongation_lower_bound(WHEEL, None, turns(1.0, 2.5), exact, tolerance=tolerance)
    assert found == pytest.approx(1.5 - 0.22, **EXACT)


def test_of_a_free_axis_its_direction_counts_and_a_cone_is_taken_off() -> None:
    exact = [(0.0, 0.0)] * 2
    for free, steps in (
        ({"about": "tool_z"}, 0.0),
        ({"about": "tool_x"}, 2.5),
        ({"about": "tool_y", "cone": 0.125}, (1.0 - 0.125) + (1.5 - 0.25)),
        ("all", 0.0),
    ):
        found = elongation_lower_bound(
            WHEEL, np.zeros(1), turns(1.0, 2.5), exact, orientation_free=free
        )
        assert found == pytest.approx(steps, rel=3e-12, abs=1e-15)
    tilt = pin.exp3(np.array([0.25, 0.0, 0.0]))
    wrist = robot_of([Joint("revolute", axis=(1, 0, 0)), Joint("revolute", axis=(0, 0, 1))])
    pose = (np.zeros(3), tilt @ pin.exp3(np.array([0.0, 0.0, 2.0])))
    found = elongation_lower_bound(
        wrist, np.zeros(2), [pose], [(0.0, 0.0)], orientation_free={"about": "tool_z"}
    )
    assert found == pytest.approx(0.25 / math.sqrt(2.0), rel=1e-11)
