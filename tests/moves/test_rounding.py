"""Corners of a way: how they are rounded, and that what is proven is the spline itself."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from ikplan import load_robot
from ikplan.collision.checker import CollisionChecker
from ikplan.documents.scene import Scene
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.planning.moves.piece_check import piece_check
from ikplan.planning.moves.rounding import round_way
from ikplan.planning.moves.way import find_way
from ikplan.scene.model import collision_model
from tests.moves.cells import post, turned

Array = NDArray[np.float64]


def test_without_obstacles_a_corner_is_cut_as_far_as_half_of_its_shorter_side() -> None:
    robot = load_robot("ur5")
    limits = JointLimits.from_robot(robot)
    first, second = np.eye(6)[:2]
    way = robot.home + np.array([0.0 * first, first, first + 0.5 * second])
    rounded = round_way(way, limits, None)
    assert rounded.rest == []
    assert np.array_equal(rounded.q[[0, -1]], way[[0, -1]])
    begin = robot.home + 0.75 * first
    assert np.abs(rounded.q - begin).sum(axis=1).min() < 1e-12
    assert rounded.length < 1.5
    # The same from its other end.
    back = round_way(way[::-1].copy(), limits, None)
    assert np.allclose(back.q[::-1], rounded.q, atol=1e-12)


def test_a_way_without_corners_stays_as_it_is() -> None:
    robot = load_robot("ur5")
    way = np.vstack([robot.home, robot.home + 0.3])
    rounded = round_way(way, JointLimits.from_robot(robot), None)
    assert np.array_equal(rounded.q, way)


@pytest.mark.parametrize("seed", range(4))
def test_the_spline_through_a_rounded_way_is_free_everywhere(seed: int) -> None:
    robot = load_robot("ur5")
    scene = Scene.model_validate({"obstacles": [post(robot)]})
    checker = CollisionChecker(robot, collision_model(robot, scene), 1e-4)
    ends = turned(robot, 0.0), turned(robot, 1.6)[None]
    cut = np.zeros(1, dtype=np.bool_)
    bounds = (robot.lower, robot.upper)
    way, samples = find_way(checker.arrays(None), bounds, *ends, None, seed, cut)
    assert way is not None
    assert samples > 0
    assert way.length <= way.found_length
    assert checker.first_contact(way.q) is None
    limits = JointLimits.from_robot(robot)
    rounded = round_way(way.q, limits, piece_check(None, checker, None))
    path = JointPath.through(rounded.q, limits, rest_at=rounded.rest)
    dense = path(np.linspace(0.0, path.length, 4000))
    assert checker.free(dense).all()


def test_a_larger_gap_cuts_corners_less() -> None:
    robot = load_robot("ur5")
    scene = Scene.model_validate({"obstacles": [post(robot)]})
    checker = CollisionChecker(robot, collision_model(robot, scene), 1e-4)
    cut = np.zeros(1, dtype=np.bool_)
    goals = turned(robot, 1.6)[None]
    way, _ = find_way(
        checker.arrays(None), (robot.lower, robot.upper), robot.home, goals, None, 0, cut
    )
    assert way is not None
    limits = JointLimits.from_robot(robot)
    check = piece_check(None, checker, None)
    lengths = [round_way(way.q, limits, check, extra).length for extra in (0.0, 0.02, 1.0)]
    assert lengths[0] <= lengths[1] + 1e-9 <= lengths[2] + 2e-9
    # No gap of a metre: the motion stops at every corner of the way itself.
    stopping = round_way(way.q, limits, check, 1.0)
    assert np.array_equal(stopping.q, way.q)
    assert stopping.rest == list(range(1, len(way.q) - 1))
