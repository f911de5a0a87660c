"""The least elongation is below every joint motion there is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan.certificate.elongation import elongation_lower_bound
from ikplan.robots import Robot, load_robot, robot_from_urdf, robot_names
from tests.kinematics.synthetic import Joint, chains, robot_of, urdf_of


def bound(robot: Robot, path: np.ndarray, *, free: bool, oriented: np.ndarray) -> float:
    poses = []
    for q, turn in zip(path[1:], oriented, strict=True):
        T = robot.fk(q)
        poses.append((T.translation, T.rotation if turn else None))
    exact = [(0.0, 0.0 if turn else None) for turn in oriented]
    return elongation_lower_bound(robot, None if free else path[0], poses, exact)


def motion(path: np.ndarray, *, free: bool) -> float:
    return float(np.linalg.norm(np.diff(path[1:] if free else path, axis=0), axis=1).sum())


@pytest.mark.parametrize("name", robot_names())
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
def test_no_joint_path_of_any_chain_undercuts_it(parts, seed: int) -> None:
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
    poses = [(np.array([1.0, 0.0, 0.0]), None)]
    start = np.zeros(1)
    assert elongation_lower_bound(slider, start, poses, [(0.0, None)]) == pytest.approx(1.0)
    assert elongation_lower_bound(slider, start, poses, [(0.3, None)]) == pytest.approx(0.7)
    assert elongation_lower_bound(slider, start, poses, [(2.0, None)]) == 0.0
