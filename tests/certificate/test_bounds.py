"""The least elongation is below every joint motion there is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.certificate.elongation import elongation_lower_bound
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedWaypoint
from ikplan.certificate.waypoints import Misses
from ikplan.documents.path import PathRequest
from ikplan.robots import Robot, load_robot, robot_from_urdf
from tests.kinematics.synthetic import Joint, chains, robot_of, urdf_of

Vector = NDArray[Any]


def asked_at(robot: Robot, path: Vector, oriented: Vector) -> list[RequestedWaypoint]:
    poses = [robot.fk(q) for q in path]
    turns = zip(poses, oriented, strict=True)
    return [RequestedWaypoint(T.translation, T.rotation if turn else None) for T, turn in turns]


def bound_of(
    robot: Robot,
    start: Vector | None,
    asked: list[RequestedWaypoint],
    missed: list[tuple[float, float]],
    **options: Any,
) -> float:
    document = {"waypoints": [{"position": [0.0, 0.0, 0.0]}], **options}
    distance, angle = np.array(missed).T
    flags = np.array([w.R is not None for w in asked])
    misses = Misses(distance, angle, flags, np.zeros(len(asked)))
    allowance = Allowance(PathRequest.model_validate(document))
    return elongation_lower_bound(robot, start, asked, allowance, misses)


def bound(robot: Robot, path: Vector, *, free: bool, oriented: Vector, **options: Any) -> float:
    asked = asked_at(robot, path[1:], oriented)
    exact = [(0.0, 0.0)] * len(asked)
    return bound_of(robot, None if free else path[0], asked, exact, **options)


def motion(path: Vector, *, free: bool) -> float:
    return float(np.linalg.norm(np.diff(path[1:] if free else path, axis=0), axis=1).sum())


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_no_joint_path_of_the_catalogue_undercuts_it(name: str) -> None:
    plain = load_robot(name)
    rng = np.random.default_rng([71, len(name)])
    for robot in (plain, plain.with_tool([0.2, -0.1, 0.3], [0.5, 0.5, 0.5, 0.5])):
        for step in (1e-3, 0.1, 10.0):
            for _ in range(10):
                path = [robot.random_configuration(rng)]
                for _ in range(5):
                    path.append(robot.clip(path[-1] + step * rng.normal(size=robot.dof)))
                q = np.array(path)
                free = bool(rng.random() < 0.3)
                oriented = rng.random(5) < 0.7
                least = bound(robot, q, free=free, oriented=oriented)
                assert 0.0 <= least <= motion(q, free=free)


@given(chains, st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_no_joint_path_of_any_chain_undercuts_it(
    parts: tuple[Sequence[Joint], Joint, Joint], seed: int
) -> None:
    robot = robot_from_urdf(urdf_of(*parts))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.9, 2.9, (5, robot.dof))
    oriented = np.ones(4, dtype=bool)
    assert bound(robot, q, free=False, oriented=oriented) <= motion(q, free=False)


def test_it_is_met_where_every_joint_motion_shows_in_the_tool() -> None:
    """One sliding joint, or one turning joint seen by its orientation, cannot be undercut."""
    slider = robot_of([Joint("prismatic", axis=(1, 0, 0))])
    wheel = robot_of([Joint("revolute", axis=(0, 1, 0))])
    q = np.array([[0.0], [0.4], [-0.2], [0.7]])
    oriented = np.ones(3, dtype=bool)
    for robot in (slider, wheel):
        least = bound(robot, q, free=False, oriented=oriented)
        assert least == pytest.approx(motion(q, free=False))
        assert least <= motion(q, free=False)


def test_what_a_plan_misses_it_need_not_have_moved() -> None:
    slider = robot_of([Joint("prismatic", axis=(1, 0, 0))])
    asked = [RequestedWaypoint(np.array([x, 0.0, 0.0]), None) for x in (1.0, 3.0)]
    start = np.zeros(1)
    for missed, least in (
        ((0.0, 0.0), 3.0),
        ((0.3, 0.0), 2.4),  # short of the first by 0.3, so 0.3 less to each
        ((0.0, 0.3), 2.7),
        ((2.0, 0.0), 0.0),
    ):
        both = [(distance, 0.0) for distance in missed]
        assert bound_of(slider, start, asked, both) == pytest.approx(least)


def test_what_the_angle_misses_counts_at_both_ends_of_a_step() -> None:
    wheel = robot_of([Joint("revolute", axis=(0, 0, 1))])
    asked = asked_at(wheel, np.array([[0.5], [1.2]]), np.ones(2, dtype=bool))
    start = np.zeros(1)
    assert bound_of(wheel, start, asked, [(0.0, 0.0), (0.0, 0.0)]) == pytest.approx(1.2)
    assert bound_of(wheel, start, asked, [(0.0, 0.1), (0.0, 0.0)]) == pytest.approx(1.0)
    assert bound_of(wheel, start, asked, [(0.0, 0.0), (0.0, 0.2)]) == pytest.approx(1.0)


def test_what_the_request_leaves_free_need_not_be_moved() -> None:
    wheel = robot_of([Joint("revolute", axis=(0, 0, 1))])
    asked = asked_at(wheel, np.array([[0.8]]), np.ones(1, dtype=bool))
    start, exact = np.zeros(1), [(0.0, 0.0)]
    for options, least in (
        ({}, 0.8),
        ({"orientation_free": "all"}, 0.0),
        ({"orientation_free": {"about": "tool_z"}}, 0.0),
        ({"orientation_free": {"about": "tool_x"}}, 0.8),
        ({"orientation_free": {"about": "tool_x", "cone": 0.3}}, 0.5),
        ({"tolerance": {"box": {"orientation": [0.0, 0.0, 0.3]}}}, 0.5),
    ):
        assert bound_of(wheel, start, asked, exact, **options) == pytest.approx(least)
    slider = robot_of([Joint("prismatic", axis=(1, 0, 0))])
    ahead = [RequestedWaypoint(np.array([1.0, 0.0, 0.0]), None)]
    box = {"tolerance": {"box": {"position": [0.2, 0.0, 0.0]}}}
    assert bound_of(slider, start, ahead, exact, **box) == pytest.approx(0.8)


@pytest.mark.parametrize("freedom", [{"about": "tool_y"}, {"about": "tool_x", "cone": 0.2}])
def test_no_joint_path_undercuts_it_where_an_axis_is_free(freedom: Any) -> None:
    robot = load_robot("panda")
    rng = np.random.default_rng(5)
    for _ in range(40):
        q = np.array([robot.random_configuration(rng) for _ in range(4)])
        free = bound(
            robot, q, free=False, oriented=np.ones(3, dtype=bool), orientation_free=freedom
        )
        assert free <= bound(robot, q, free=False, oriented=np.ones(3, dtype=bool))
        assert free <= motion(q, free=False)
