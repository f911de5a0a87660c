"""Laws of every tool path: parametrised by length, continuous, exact, bound to no frame."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from ikplan.path import Pose, ToolPath
from ikplan.path.rotation.so3 import angle_between, exp, log, quaternion_of, rotation_of

from .requests import START, START_R, of_segments, pose, quaternion, random_poses, seeds, through

CURVES: dict[str, dict[str, Any]] = {
    "line": {"type": "line", "to": pose([0.5, 0.3, 0.2], [0.5, -0.4, 0.1])},
    "arc": {"type": "arc", "via": [0.5, 0.1, 0.6], "to": pose([0.5, 0.4, 0.4], [0.3, 0.1, -0.8])},
    "turned arc": {
        "type": "arc", "centre": [0.1, 0.2, 0.3], "angle": -4.0, "axis": [0.2, 0.4, 1.0],
        "orientation": "follow",
    },
    "spline": {"type": "spline", "through": random_poses(3, 6)},
    "circle": {"type": "circle", "radius": 0.1, "angle": -7.0, "orientation": "follow"},
    "helix": {"type": "helix", "radius": 0.2, "rise": -0.5, "turns": 2.0},
    "rose": {"type": "rose", "radius": 0.15, "orientation": "follow"},
    "sinusoid": {
        "type": "sinusoid", "length": 0.6, "amplitude": 0.1, "wavelength": 0.3, "phase": 0.4,
        "orientation": {"quaternion_xyzw": quaternion([1.0, 0.2, 0.1])},
    },
    "sawtooth": {
        "type": "sawtooth", "length": 0.4, "height": 0.1, "teeth": 3, "fall": 0.2, "blend": 0.01,
        "orientation": {"quaternion_xyzw": quaternion([-0.3, 0.2, 0.1])},
    },
    "trapezoid": {"type": "trapezoid", "length": 0.4, "height": -0.1, "periods": 2},
}  # fmt: skip


@pytest.fixture(scope="module", params=CURVES, ids=list(CURVES))
def path(request: pytest.FixtureRequest) -> ToolPath:
    return of_segments(CURVES[request.param])


def test_the_parameter_is_the_arc_length(path: ToolPath) -> None:
    s = np.linspace(0.0, path.length, 403)
    assert_allclose(np.linalg.norm(path.derivatives(s).v, axis=1), 1.0, rtol=0.0, atol=1e-12)
    # Richardson's extrapolation of chords over h and h/2 leaves an error of order h^4.
    h = 2e-5
    inside = s[(s > h) & (s < path.length - h)]
    at_joints = np.concatenate([path.begins, path.corners])
    inside = inside[np.abs(inside[:, None] - at_joints).min(axis=1) > 2 * h]
    chords = [
        np.linalg.norm(path.poses(inside + x)[1] - path.poses(inside - x)[1], axis=1) / (2 * x)
        for x in (h, h / 2)
    ]
    assert_allclose((4.0 * chords[1] - chords[0]) / 3.0, 1.0, rtol=0.0, atol=2e-9)


def test_the_derivatives_are_those_of_the_poses(path: ToolPath) -> None:
    h = 1e-6
    s = np.linspace(0.0, path.length, 203)[1:-1]
    joints = np.concatenate([path.begins, path.corners])
    s = s[np.abs(s[:, None] - joints).min(axis=1) > 2 * h]
    before, at, after = path.derivatives(s - h), path.derivatives(s), path.derivatives(s + h)
    assert_allclose((after.p - before.p) / (2 * h), at.v, rtol=0.0, atol=1e-6)
    assert_allclose((after.v - before.v) / (2 * h), at.bend, rtol=1e-5, atol=1e-3)
    rate = log(after.R @ np.swapaxes(before.R, 1, 2)) / (2 * h)
    assert_allclose(rate, at.w, rtol=1e-5, atol=1e-4)


def test_pieces_join_without_a_gap(path: ToolPath) -> None:
    ends = [piece.pose(1.0) for piece in path.pieces[:-1]]
    begins = [piece.pose(0.0) for piece in path.pieces[1:]]
    for (R0, p0), (R1, p1) in zip(ends, begins, strict=True):
        assert_allclose(p0, p1, atol=1e-13)
        assert_allclose(R0, R1, atol=1e-12)
    assert_allclose(path.pose(0.0)[0], START_R, atol=1e-15)
    assert_allclose(path.pose(0.0)[1], START.p, atol=1e-15)


def test_the_direction_jumps_at_corners_and_nowhere_else(path: ToolPath) -> None:
    h = 1e-9
    joints = path.begins[1:-1]
    a, b = path.derivatives(joints - h), path.derivatives(joints + h)
    jumps = np.linalg.norm(a.v - b.v, axis=1) + 0.3 * np.linalg.norm(a.w - b.w, axis=1) > 1e-5
    assert_allclose(joints[jumps], path.corners, atol=1e-12)


def test_poses_asked_for_are_passed_exactly(path: ToolPath) -> None:
    assert [w.row for w in path.waypoints] == list(range(len(path.waypoints)))
    assert (np.diff(path.waypoint_s) > 0.0).all()
    for waypoint in path.waypoints:
        R, p = path.pose(waypoint.s)
        if waypoint.exact:
            assert_allclose(p, waypoint.p, atol=1e-14)
            assert waypoint.R is not None
            assert_allclose(R, waypoint.R, atol=1e-13)


@pytest.mark.parametrize("name", CURVES)
@settings(max_examples=4, deadline=None)
@given(seeds)
def test_a_rigid_motion_of_the_path_frame_moves_the_path(name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    M, m = exp(rng.normal(size=3)), rng.normal(size=3)
    q = quaternion_of(M).tolist()
    plain = of_segments(CURVES[name])
    moved = of_segments(
        CURVES[name],
        start=Pose(M @ START_R, m + M @ START.p),
        frame={"position": m.tolist(), "quaternion_xyzw": q},
    )
    M = rotation_of(q)
    assert moved.length == pytest.approx(plain.length, abs=1e-11)
    s = np.linspace(0.0, min(plain.length, moved.length), 50)
    (R, p), (Rm, pm) = plain.poses(s), moved.poses(s)
    assert_allclose(pm, m + p @ M.T, atol=1e-10)
    assert_allclose(Rm, M @ R, atol=1e-9)


@pytest.mark.parametrize("interpolation", ["line", "spline"])
@pytest.mark.parametrize("blend", [0.0, 0.004])
@settings(max_examples=8, deadline=None)
@given(seeds, st.integers(2, 7))
def test_the_way_back_is_the_same_way(
    interpolation: str, blend: float, seed: int, count: int
) -> None:
    poses = random_poses(seed, count)
    more = {"blend": blend} if interpolation == "line" else {}
    there = through(poses, interpolation, None, **more)
    back = through(poses[::-1], interpolation, None, **more)
    assert back.length == pytest.approx(there.length, rel=1e-10)
    assert len(back.corners) == len(there.corners)
    s = np.linspace(0.0, there.length, 60)[1:-1]
    (R0, p0), (R1, p1) = there.poses(s), back.poses(there.length - s)
    assert_allclose(p0, p1, atol=1e-9)
    assert_allclose(R0, R1, atol=1e-8)


@settings(max_examples=20, deadline=None)
@given(seeds, st.integers(0, 5))
def test_the_sign_of_a_quaternion_means_nothing(seed: int, flipped: int) -> None:
    poses = random_poses(seed, 6)
    other = [dict(p) for p in poses]
    other[flipped]["quaternion_xyzw"] = [-c for c in poses[flipped]["quaternion_xyzw"]]
    for interpolation in ("line", "spline"):
        a, b = through(poses, interpolation), through(other, interpolation)
        s = np.linspace(0.0, a.length, 40)
        assert_allclose(a.poses(s)[0], b.poses(s)[0], atol=1e-12)


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_a_line_turns_evenly_by_the_shortest_arc(seed: int) -> None:
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    turn = axis / np.linalg.norm(axis) * rng.uniform(0.0, math.pi - 1e-3)
    path = through([pose([1.0, 0.0, 0.0], turn)], "line", Pose(np.eye(3), np.zeros(3)))
    u = np.linspace(0.0, 1.0, 21)
    assert_allclose(path.poses(u)[0], exp(u[:, None] * turn), atol=1e-12)


@settings(max_examples=15, deadline=None)
@given(seeds, st.floats(0.05, 0.95))
def test_a_line_split_in_two_is_the_same_line(seed: int, share: float) -> None:
    (last,) = random_poses(seed, 1)
    whole = through([last], "line")
    R, p = whole.pose(share * whole.length)
    middle = {"position": p.tolist(), "quaternion_xyzw": quaternion_of(R).tolist()}
    split = through([middle, last], "line")
    assert len(split.corners) == 0
    s = np.linspace(0.0, whole.length, 30)
    (R0, p0), (R1, p1) = whole.poses(s), split.poses(np.minimum(s, split.length))
    assert_allclose(p0, p1, atol=1e-12)
    assert angle_between(R0, R1).max() < 1e-12
