"""The measure of a tool pose against a path, against brute force and by its own law."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from ikplan.path import Pose, path_deviation
from ikplan.path.rotation import angle_between, exp

from .requests import of_segments, pose, quaternion, random_poses, seeds, through

PATHS = {
    "lines": lambda seed: through(random_poses(seed, 5), "line"),
    "blended lines": lambda seed: through(random_poses(seed, 5), "line", blend=0.003),
    "spline": lambda seed: through(random_poses(seed, 6), "spline"),
    "helix": lambda seed: of_segments(
        {"type": "helix", "radius": 0.05 + 1e-3 * (seed % 7), "rise": 0.1, "turns": 3}
    ),
    "positions": lambda seed: through(random_poses(seed, 6, oriented=False), "spline"),
}


@pytest.mark.parametrize("kind", PATHS)
@settings(max_examples=8, deadline=None)
@given(seeds)
def test_poses_of_the_path_are_on_it_whatever_the_hint(kind, seed):
    path, rng = PATHS[kind](seed), np.random.default_rng(seed)
    s = np.sort(rng.uniform(0.0, path.length, 150))
    R, p = path.poses(s)
    hint = s + rng.uniform(-0.009, 0.009, len(s))
    distance, angle, _ = path_deviation(path, p, R, hint)
    assert distance.max() < 1e-9
    assert angle.max() < 1e-8


@pytest.mark.parametrize("kind", PATHS)
@settings(max_examples=6, deadline=None)
@given(seeds, st.sampled_from([1e-6, 1e-4, 3e-3]))
def test_the_distance_is_that_of_brute_force(kind, seed, size):
    path, rng = PATHS[kind](seed), np.random.default_rng(seed)
    s = rng.uniform(0.0, path.length, 20)
    R, p = path.poses(s)
    p = p + rng.normal(size=p.shape) * size
    window = 0.008
    distance, _, at = path_deviation(path, p, R, s, window=window, rotation_weight=0.0)
    stations = np.linspace(-window, window, 801)
    near = np.clip(s[:, None] + stations, 0.0, path.length)
    points = path.poses(near.ravel())[1].reshape(*near.shape, 3)
    brute = np.linalg.norm(points - p[:, None], axis=2).min(axis=1)
    assert (distance <= brute + 1e-12).all()
    assert (distance >= brute - 2.0 * window / 800).all()
    assert_allclose(np.linalg.norm(path.poses(at)[1] - p, axis=1), distance, atol=1e-12)
    assert (np.abs(at - s) <= window * (1 + 1e-12)).all()


@settings(max_examples=20, deadline=None)
@given(seeds, st.floats(1e-6, 1e-2), st.floats(1e-6, 1e-1))
def test_an_offset_across_a_line_is_measured_as_it_is(seed, offset, turn):
    rng = np.random.default_rng(seed)
    path = through([pose([1.0, 0.0, 0.0], [0.0, 0.0, 0.0])], "line", Pose(np.eye(3), np.zeros(3)))
    s = rng.uniform(0.0, 1.0, 30)
    across = rng.normal(size=(30, 3))
    across[:, 0] = 0.0
    across *= offset / np.linalg.norm(across, axis=1)[:, None]
    axis = rng.normal(size=3)
    R = exp(axis / np.linalg.norm(axis) * turn)
    distance, angle, at = path_deviation(
        path, path.poses(s)[1] + across, np.broadcast_to(R, (30, 3, 3)), s + 1e-3
    )
    assert_allclose(distance, offset, rtol=1e-9)
    assert_allclose(angle, turn, rtol=1e-9)
    assert_allclose(at, s, atol=1e-9)


def test_one_pose_of_the_path_bears_out_both_figures():
    path = through(random_poses(3, 5), "line")
    rng = np.random.default_rng(0)
    s = rng.uniform(0.0, path.length, 200)
    R, p = path.poses(s)
    p = p + rng.normal(size=p.shape) * 1e-3
    R = R @ exp(rng.normal(size=p.shape) * 1e-2)
    distance, angle, at = path_deviation(path, p, R, s)
    R_at, p_at = path.poses(at)
    assert_allclose(np.linalg.norm(p - p_at, axis=1), distance, atol=1e-12)
    assert_allclose(angle_between(R_at, R), angle, atol=1e-12)
    cost = distance**2 + (0.1 * angle) ** 2
    for step in (-1e-5, 1e-5, 1e-3, -1e-3):
        R_by, p_by = path.poses(np.clip(at + step, 0.0, path.length))
        other = ((p - p_by) ** 2).sum(axis=1) + (0.1 * angle_between(R_by, R)) ** 2
        assert (other >= cost - 1e-12).all()


def test_a_turn_on_the_spot_is_measured_by_its_orientation():
    poses = [pose([0.1, 0, 0], [0, 0, 0]), pose([0.1, 0, 0], [0, 0, 1.0]), pose([0.1, 0.1, 0])]
    path = through(poses, "line", Pose(np.eye(3), np.zeros(3)))
    s = np.linspace(0.1, 0.4, 61)[1:-1]
    R, p = path.poses(s)
    tilt = exp(np.array([0.02, 0.0, 0.0]))
    distance, angle, at = path_deviation(path, p + np.array([0, 0, 1e-3]), R @ tilt, s + 0.004)
    assert_allclose(distance, 1e-3, rtol=1e-9)
    # The end of the turn leaves nothing unmeasured, though a free span follows.
    assert_allclose(angle, 0.02, rtol=1e-3)
    assert_allclose(at, s, atol=1e-3)


def test_a_turn_on_the_spot_is_measured_at_its_hint_if_rotation_has_no_weight():
    poses = [pose([0.1, 0, 0], [0, 0, 0]), pose([0.1, 0, 0], [0, 0, 1.0]), pose([0.1, 0.1, 0])]
    path = through(poses, "line", Pose(np.eye(3), np.zeros(3)))
    s = np.linspace(0.0, path.length, 101)
    R, p = path.poses(s)
    distance, angle, at = path_deviation(path, p, R, s, rotation_weight=0.0)
    assert distance.max() < 1e-12
    assert angle.max() < 1e-9
    assert_allclose(at, s, atol=1e-9)


def test_no_rotation_is_measured_where_none_is_asked_for():
    path = through(random_poses(1, 5, oriented=False), "spline")
    s = np.linspace(0.0, path.length, 50)
    _, p = path.poses(s)
    R = exp(np.random.default_rng(0).normal(size=(50, 3)))
    distance, angle, _ = path_deviation(path, p, R, s)
    assert distance.max() < 1e-10
    assert not angle.any()


def test_a_path_of_no_length_and_no_poses_can_be_measured():
    here = Pose(np.eye(3), np.zeros(3))
    path = through([pose([0, 0, 0], [0, 0, 0])], "line", here)
    R = exp(np.array([[0.0, 0.0, 0.1]]))
    distance, angle, _ = path_deviation(path, np.array([[0.0, 0.3, 0.4]]), R, np.zeros(1))
    assert (distance[0], angle[0]) == pytest.approx((0.5, 0.1))
    assert [len(x) for x in path_deviation(path, np.zeros((0, 3)), R[:0], np.zeros(0))] == [0] * 3


def test_an_end_orientation_off_by_a_known_angle_is_found():
    path = of_segments({"type": "circle", "radius": 0.1, "quaternion_xyzw": quaternion([1, 0, 0])})
    s = np.linspace(path.waypoint_s[0] + 0.02, path.length, 80)
    R, p = path.poses(s)
    _, angle, _ = path_deviation(path, p, R @ exp(np.array([0.0, 3e-3, 0.0])), s)
    assert_allclose(angle, 3e-3, rtol=1e-6)


def test_the_last_of_an_oriented_span_is_held_to_it_though_a_free_span_follows():
    here = Pose(np.eye(3), np.zeros(3))
    path = through([pose([0.1, 0, 0], [0, 0, 0]), pose([0.2, 0, 0])], "line", here)
    joint = path.waypoint_s[0]
    s = joint + np.array([-3e-4, -1e-4, -1e-6, 1e-6, 1e-4])
    tilted = np.broadcast_to(path.pose(joint)[0] @ exp(np.array([0.02, 0.0, 0.0])), (5, 3, 3))
    distance, angle, _ = path_deviation(path, path.poses(s)[1], tilted, s)
    assert_allclose(distance, 0.0, atol=1e-12)
    assert_allclose(angle, [0.02, 0.02, 0.02, 0.0, 0.0], atol=1e-9)
