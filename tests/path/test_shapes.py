"""Lines, arcs, splines and named curves against their formulas."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from ikplan import InvalidRequest
from ikplan.path import Pose, ToolPath
from ikplan.path.rotation.so3 import angle_between, exp, log

from .requests import (
    START,
    Array,
    of_segments,
    pose,
    quaternion,
    random_poses,
    seeds,
    through,
    tool_path,
)

FRAME = {"position": [0.3, -0.2, 0.5], "quaternion_xyzw": quaternion([0.4, 1.0, -0.3])}
ORIGIN, AXES = np.array(FRAME["position"]), exp(np.array([0.4, 1.0, -0.3]))


def curve(**fields: Any) -> ToolPath:
    """The curve alone, drawn in FRAME, from a free start."""
    return of_segments(
        {"frame": FRAME, "quaternion_xyzw": quaternion([1.0, 0.0, 0.2]), **fields}, start=None
    )


def local(path: ToolPath, s: ArrayLike) -> Array:
    """Positions in the frame of the curve."""
    positions: Array = (path.poses(np.asarray(s))[1] - ORIGIN) @ AXES
    return positions


def test_a_helix_is_that_of_its_formula() -> None:
    path = curve(type="helix", radius=0.2, rise=-0.5, turns=-2.25, phase=0.7)
    u = np.linspace(0.0, 1.0, 101)
    a = 0.7 - 2.25 * 2.0 * np.pi * u
    wanted = np.stack([0.2 * np.cos(a), 0.2 * np.sin(a), -0.5 * u], axis=1)
    assert_allclose(local(path, u * path.length), wanted, atol=1e-13)
    assert path.length == pytest.approx(math.hypot(0.2 * 2.25 * 2 * np.pi, 0.5), rel=1e-14)


def test_a_circle_is_that_of_its_formula() -> None:
    path = curve(type="circle", radius=0.1, angle=7.0, phase=-0.4)
    a = np.linspace(-0.4, 6.6, 101)
    wanted = 0.1 * np.stack([np.cos(a), np.sin(a), 0.0 * a], axis=1)
    assert_allclose(local(path, np.linspace(0.0, path.length, 101)), wanted, atol=1e-14)


@pytest.mark.parametrize("petals", [1, 2, 3, 5])
def test_a_rose_is_that_of_its_formula_and_closes(petals: int) -> None:
    path = curve(type="rose", radius=0.15, petals=petals, phase=0.3)
    x, y, z = local(path, np.linspace(0.0, path.length, 1001)).T
    assert_allclose(z, 0.0, atol=1e-14)
    # A point of polar angle b is on it with rho = cos(petals b), or as its opposite.
    rho, b = np.hypot(x, y), np.arctan2(y, x)
    miss = [np.abs(sign * rho - 0.15 * np.cos(petals * (b + turn)))
            for sign, turn in ((1.0, 0.0), (-1.0, np.pi))]  # fmt: skip
    assert np.minimum(*miss)[rho > 1e-3].max() < 1e-12
    assert_allclose(path.pose(0.0)[1], path.pose(path.length)[1], atol=1e-13)


def test_a_sinusoid_is_that_of_its_formula() -> None:
    path = curve(type="sinusoid", length=0.7, amplitude=-0.1, wavelength=0.3, phase=0.5)
    x, y, z = local(path, np.linspace(0.0, path.length, 501)).T
    assert_allclose(y, -0.1 * np.sin(2.0 * np.pi * x / 0.3 + 0.5), atol=1e-13)
    assert_allclose(z, 0.0, atol=1e-14)
    assert (np.diff(x) > 0.0).all()
    assert (x[0], x[-1]) == pytest.approx((0.0, 0.7), abs=1e-13)


@pytest.mark.parametrize("fall", [0.0, 0.25, 1.0])
def test_a_sawtooth_has_its_corners(fall: float) -> None:
    path = curve(type="sawtooth", length=0.6, height=0.1, teeth=3, fall=fall)
    x = np.array([0, 1 - fall, 1, 2 - fall, 2, 3 - fall, 3]) * 0.2
    y = np.array([0, 0.1, 0, 0.1, 0, 0.1, 0])
    ends = [0.0, *path.corners, path.length]
    wanted = np.unique(np.stack([x, y, 0 * x], axis=1), axis=0)
    assert_allclose(np.unique(local(path, ends).round(12) + 0.0, axis=0), wanted, atol=1e-12)


@pytest.mark.parametrize("ramp", [0.0, 0.1, 0.5])
def test_a_trapezoid_has_its_corners(ramp: float) -> None:
    path = curve(type="trapezoid", length=0.8, height=0.1, periods=2, ramp=ramp)
    one = [(0, 0), (ramp, 0.1), (0.5, 0.1), (0.5 + ramp, 0)]
    points = {(round(0.4 * (k + x), 9), y, 0.0) for k in (0, 1) for x, y in one} | {(0.8, 0, 0)}
    found = local(path, [0.0, *path.corners, path.length]).round(9) + 0.0
    assert {tuple(row) for row in found.tolist()} == points


@settings(max_examples=40, deadline=None)
@given(seeds, st.floats(0.05, 2 * math.pi - 0.05), st.floats(0.02, 0.98))
def test_an_arc_by_its_points_is_the_arc_by_its_centre(
    seed: int, angle: float, share: float
) -> None:
    rng = np.random.default_rng(seed)
    axis, spoke = exp(rng.normal(size=3))[:, :2].T
    centre, radius = rng.normal(size=3), rng.uniform(0.01, 2.0)
    points = [centre + radius * exp(axis * a) @ spoke for a in (0.0, share * angle, angle)]
    start = Pose(None, points[0])
    by_points = {"type": "arc", "via": points[1].tolist(), "to": pose(points[2])}
    by_centre = {
        "type": "arc", "centre": centre.tolist(), "angle": angle, "axis": axis.tolist(),
        "orientation": "free",
    }  # fmt: skip
    a, b = of_segments(by_points, start=start), of_segments(by_centre, start=start)
    assert a.length == pytest.approx(radius * angle, rel=1e-9)
    u = np.linspace(0.0, 1.0, 41)
    assert_allclose(a.poses(u * a.length)[1], b.poses(u * b.length)[1], atol=1e-8)
    assert_allclose(a.pose(a.length)[1], points[2], atol=1e-13)


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-8, 1e-3))
def test_a_flat_arc_is_exact_up_to_the_line_it_becomes(bulge: float) -> None:
    p = np.array([[0.0, 0.0, 0.0], [0.5, bulge, 0.0], [1.0, 0.0, 0.0]])
    path = of_segments(
        {"type": "arc", "via": p[1].tolist(), "to": pose(p[2])}, start=Pose(None, p[0])
    )
    at_points = path.poses(np.array([0.0, 0.5 * path.length, path.length]))[1]
    assert_allclose(at_points, p, atol=1e-14)
    assert path.length == pytest.approx(1.0 + 8.0 / 3.0 * bulge**2, abs=1e-10)


def test_an_arc_through_points_on_a_line_is_the_line() -> None:
    start = Pose(None, np.zeros(3))
    path = of_segments({"type": "arc", "via": [0.3, 0, 0], "to": pose([1, 0, 0])}, start=start)
    s = np.linspace(0.0, 1.0, 11)
    assert_allclose(path.poses(s)[1], s[:, None] * np.eye(3)[0], atol=1e-15)


@pytest.mark.parametrize(
    ("arc", "words"),
    [
        ({"via": [1.3, 0, 0], "to": pose([1, 0, 0])}, "on a line"),
        ({"via": [0, 0, 0], "to": pose([1, 0, 0])}, "coincide"),
        ({"via": [1, 0, 0], "to": pose([0, 0, 0])}, "full circle"),
        ({"centre": [0, 0, 2], "angle": 1.0, "orientation": "free"}, "own axis"),
    ],
)
def test_points_that_make_no_arc_are_refused(arc: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidRequest, match=words) as caught:
        of_segments({"type": "arc", **arc}, start=Pose(None, np.zeros(3)))
    assert caught.value.field == "path.segments[0]"


@settings(max_examples=15, deadline=None)
@example(7401, 5)
@given(seeds, st.integers(3, 12))
def test_a_spline_is_c2_and_passes_every_pose(seed: int, count: int) -> None:
    path = through(random_poses(seed, count), "spline")
    assert len(path.pieces) == 1
    knots = path.waypoint_s[:-1]
    h = 1e-9
    before, after = path.derivatives(knots - h), path.derivatives(knots + h)
    scale = 1.0 + np.abs(after.bend).max()
    assert_allclose(before.v, after.v, atol=1e-7 * scale)
    assert_allclose(before.bend, after.bend, atol=1e-5 * scale**2)
    # The same for the angular rate, and its derivative by one-sided differences of second order.
    assert_allclose(before.w, after.w, atol=1e-6 * scale)
    d = 1e-6
    w = {k: path.derivatives(knots + k * d).w for k in (-2, -1, 0, 1, 2)}
    left = (3.0 * w[0] - 4.0 * w[-1] + w[-2]) / (2.0 * d)
    right = (4.0 * w[1] - 3.0 * w[0] - w[2]) / (2.0 * d)
    assert_allclose(left, right, atol=1e-3 * (1.0 + np.abs(right).max()) * scale)


def test_a_spline_of_two_poses_is_the_line() -> None:
    (last,) = random_poses(5, 1)
    s = np.linspace(0.0, 0.2, 20)
    for a, b in zip(
        through([last], "spline").poses(s), through([last], "line").poses(s), strict=True
    ):
        assert_allclose(a, b, atol=0.0)


def test_a_spline_through_a_circle_tends_to_it_with_the_third_power_or_better() -> None:
    errors = []
    for n in (17, 33, 65):
        a = np.linspace(0.0, np.pi, n)
        points = np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
        path = through([pose(p) for p in points], "spline", None)
        # The ends of a natural spline are of second order; half way they do not matter.
        s = np.linspace(0.3, 0.7, 200) * path.length
        errors.append(np.abs(np.linalg.norm(path.poses(s)[1], axis=1) - 1.0).max())
    assert errors[0] / errors[1] > 8.0
    assert errors[1] / errors[2] > 8.0


def test_a_spline_stops_where_it_turns_back() -> None:
    there_and_back = [pose([1, 0, 0]), pose([0, 0, 0])]
    path = through(there_and_back, "spline", Pose(None, np.zeros(3)))
    assert_allclose(path.corners, [1.0], atol=1e-8)
    assert_allclose(path.pose(1.0)[1], [1, 0, 0], atol=1e-9)
    assert path.length == pytest.approx(2.0, abs=1e-8)


def test_a_repeated_position_ends_one_spline_and_begins_another() -> None:
    poses = random_poses(9, 5)
    poses.insert(3, {**poses[2], "quaternion_xyzw": quaternion([0.3, 0.9, 0.0])})
    poses.insert(4, dict(poses[3]))
    path = through(poses, "spline")
    spot = [piece for piece in path.pieces if piece.turns]
    assert len(path.pieces) == 3
    assert len(spot) == 1
    angle = Rotation.from_quat(poses[2]["quaternion_xyzw"]).inv() * Rotation.from_quat(
        poses[3]["quaternion_xyzw"]
    )
    assert spot[0].length == pytest.approx(0.3 * angle.magnitude(), rel=1e-12)
    assert_allclose(path.corners, path.waypoint_s[[2, 3]], atol=1e-12)
    assert path.waypoint_s[3] == path.waypoint_s[4]


@pytest.mark.parametrize("interpolation", ["line", "spline"])
def test_orientation_counts_up_to_the_last_pose_that_has_one(interpolation: str) -> None:
    poses = random_poses(2, 6)
    for k in (1, 3, 4, 5):
        del poses[k]["quaternion_xyzw"]
    path = through(poses, interpolation)
    s = path.waypoint_s
    middles = 0.5 * (np.concatenate([[0.0], s[:-1]]) + s)
    assert path.orientation_mask(middles).tolist() == [True, True, True, False, False, False]
    assert path.oriented(float(s[2]))
    assert not path.oriented(float(s[2]) + 1e-9)
    for k in (0, 2):
        R = path.waypoints[k].R
        assert R is not None
        assert_allclose(path.pose(float(s[k]))[0], R, atol=1e-12)
    assert [w.R is None for w in path.waypoints] == [k in (1, 3, 4, 5) for k in range(6)]
    # In between, the tool has turned by as much of the turn as it has come of the way.
    p = [np.array(pose["position"]) for pose in poses[:3]]
    ways = [np.linalg.norm(b - a) for a, b in itertools.pairwise(p)]
    first, last = path.waypoints[0].R, path.waypoints[2].R
    assert first is not None
    assert last is not None
    turn = log(first.T @ last)
    half = first @ exp(turn * ways[0] / sum(ways))
    assert_allclose(path.pose(float(s[1]))[0], half, atol=1e-9)
    if interpolation == "line":
        R = path.poses(np.linspace(s[0], s[2], 41))[0]
        steps = [angle_between(a, b) for a, b in itertools.pairwise(R)]
        assert_allclose(steps, np.mean(steps), rtol=1e-6)


def test_follow_keeps_the_angle_between_tool_and_direction() -> None:
    for segment in (
        {"type": "circle", "radius": 0.1, "angle": -9.0},
        {"type": "helix", "radius": 0.1, "rise": 0.3, "turns": 2.5},
        {"type": "rose", "radius": 0.2, "petals": 4},
        {"type": "sinusoid", "length": 1.0, "amplitude": 0.2, "wavelength": 0.3},
    ):
        path = curve(**segment, orientation="follow")
        motion = path.derivatives(np.linspace(0.0, path.length, 301))
        seen = np.einsum("mji,mj->mi", motion.R, motion.v)
        assert_allclose(seen, np.broadcast_to(seen[0], seen.shape), atol=1e-9)
        # The turn is about the z axis of the curve's frame alone.
        axis = np.einsum("mji,j->mi", motion.R, AXES[:, 2])
        assert_allclose(axis, np.broadcast_to(axis[0], axis.shape), atol=1e-12)


def test_an_end_orientation_is_reached_evenly_over_all_pieces() -> None:
    end = quaternion([0.9, -0.8, 0.3])
    path = curve(
        type="sawtooth", length=0.6, height=0.1, teeth=2, orientation={"quaternion_xyzw": end}
    )
    u = np.linspace(0.0, 1.0, 31)
    R = path.poses(u * path.length)[0]
    first = Rotation.from_matrix(R[0])
    turn = (first.inv() * Rotation.from_quat(end)).as_rotvec()
    assert_allclose(R, (first * Rotation.from_rotvec(u[:, None] * turn)).as_matrix(), atol=1e-12)


def test_a_half_turn_needs_an_axis() -> None:
    half = pose([0.5, 0, 0], [0.0, 0.0, np.pi])
    origin = Pose(np.eye(3), np.zeros(3))
    for interpolation in ("line", "spline"):
        poses = [pose([0.2, 0.1, 0], [0, 0, 0]), half, pose([0.6, 0.3, 0], [0, 0, 3.0])]
        with pytest.raises(InvalidRequest, match="180 degrees") as caught:
            through(poses, interpolation, origin)
        assert "path.waypoints[0] and path.waypoints[1]" in caught.value.detail
    with pytest.raises(InvalidRequest, match=r"the start and path\.waypoints\[0\]"):
        through([half], "line", origin)
    nearly = pose([0.5, 0, 0], [0.0, 0.0, np.pi - 1e-4])
    assert through([nearly], "line", origin).length == pytest.approx(0.5)
    for sense in (1.0, -1.0):
        line = {"type": "line", "to": half, "turn_axis": [0.3, 0.0, sense]}
        R, _ = of_segments(line, start=origin).pose(0.25)
        assert_allclose(R, exp(np.array([0, 0, sense * np.pi / 2])), atol=1e-12)
    with pytest.raises(InvalidRequest, match="right angles"):
        of_segments({"type": "line", "to": half, "turn_axis": [1.0, 0, 0]}, start=origin)


def test_turn_axis_chooses_the_long_way_if_it_says_so() -> None:
    origin = Pose(np.eye(3), np.zeros(3))
    to = pose([0.5, 0, 0], [0.0, 0.0, 1.0])
    path = of_segments({"type": "line", "to": to, "turn_axis": [0, 0, -1.0]}, start=origin)
    R, _ = path.pose(0.25)
    assert_allclose(R, exp(np.array([0, 0, 0.5 * (1.0 - 2 * np.pi)])), atol=1e-12)
    assert_allclose(path.pose(0.5)[0], exp(np.array([0, 0, 1.0])), atol=1e-12)


def test_a_half_turn_about_a_free_axis_is_no_question() -> None:
    origin = Pose(np.eye(3), np.zeros(3))
    document = {"waypoints": [pose([0.5, 0, 0], [0, 0, np.pi])], "interpolation": "line"}
    path = tool_path({**document, "orientation_free": {"about": "tool_z"}}, origin)
    assert_allclose(path.poses(np.linspace(0, 0.5, 9))[0][:, :, 2], np.eye(3)[[2] * 9], atol=1e-12)
    with pytest.raises(InvalidRequest, match="180"):
        tool_path({**document, "orientation_free": {"about": "tool_x"}}, origin)
    free = tool_path({**document, "orientation_free": "all"}, origin)
    assert not any(piece.oriented for piece in free.pieces)


def test_a_large_turn_on_a_short_way_does_not_swing() -> None:
    way = [(0.0, 0.0), (0.3, 0.1), (0.31, 1.1), (0.6, 1.2), (0.9, 1.3)]
    path = through([pose([x, x * x, 0.0], [0, 0, a]) for x, a in way], "spline", None)
    angle = log(path.poses(np.linspace(0.0, path.length, 2001))[0])
    assert (np.diff(angle[:, 2]) > 0.0).all()
    assert_allclose(angle[:, :2], 0.0, atol=1e-12)
    knots = path.waypoint_s[1:-1]
    assert_allclose(log(path.poses(knots)[0])[:, 2], [0.1, 1.1, 1.2], atol=1e-12)
    h, d = 1e-9, 1e-6
    assert_allclose(path.derivatives(knots - h).w, path.derivatives(knots + h).w, atol=1e-4)
    left = (path.derivatives(knots).w - path.derivatives(knots - d).w) / d
    right = (path.derivatives(knots + d).w - path.derivatives(knots).w) / d
    # Angular acceleration is continuous; it changes at a finite rate over 2d.
    dense = path.derivatives(np.linspace(0.0, path.length, 20001)).w[:, 2]
    jerk = np.abs(np.diff(dense, 2)).max() / (path.length / 20000) ** 2
    assert_allclose(left, right, atol=4.0 * d * jerk)


def test_orientations_that_would_swing_all_the_same_are_refused() -> None:
    turns: list[list[float]] = [[0, 0, 0], [2.5, 0, 0], [0, 2.5, 0], [0, 0, 2.5], [-2.5, 0, 0]]
    uneven, even = [0.0, 0.3, 0.301, 0.302, 0.9], [0.0, 0.2, 0.4, 0.6, 0.8]
    poses = [pose([x, x * x, 0.0], turn) for x, turn in zip(uneven, turns, strict=True)]
    with pytest.raises(InvalidRequest, match="swinging") as caught:
        through(poses, "spline", None)
    assert caught.value.field in {f"path.waypoints[{k}]" for k in range(1, 5)}
    assert through(poses, "line", None).length > 0.9
    poses = [pose([x, x * x, 0.0], turn) for x, turn in zip(even, turns, strict=True)]
    assert any(piece.oriented for piece in through(poses, "spline", None).pieces)


def test_a_path_of_no_length_is_a_path() -> None:
    here = {"position": START.p.tolist()}
    for document in (
        {"waypoints": [here], "interpolation": "line"},
        {"waypoints": [here, here], "interpolation": "spline"},
        {"segments": [{"type": "line", "to": here}]},
    ):
        path = tool_path(document)
        assert path.length == 0.0
        assert_allclose(path.pose(0.0)[1], START.p, atol=0.0)
        assert (path.waypoint_s == 0.0).all()
        assert len(path.corners) == 0


@settings(max_examples=25, deadline=None)
@given(
    seeds, st.sampled_from([1e-12, 1e-10, 1e-8, 1e-6, 1e-4]), st.sampled_from(["line", "spline"])
)
def test_tiny_steps_do_no_harm(seed: int, size: float, interpolation: str) -> None:
    poses = random_poses(seed, 6, spread=size)
    poses += random_poses(seed + 1, 2)
    # A spline swings if it has to turn within nothing; the positions alone are then the test.
    free = "all" if interpolation == "spline" and size < 1e-2 else None
    path = through(poses, interpolation, None, orientation_free=free)
    motion = path.derivatives(np.linspace(0.0, path.length, 301))
    assert all(np.isfinite(field).all() for field in motion)
    assert_allclose(
        motion.R @ np.swapaxes(motion.R, 1, 2), np.eye(3)[None].repeat(301, 0), atol=1e-12
    )
    for waypoint in path.waypoints:
        R, p = path.pose(waypoint.s)
        assert_allclose(p, waypoint.p, atol=2e-9)
        if waypoint.R is not None:
            # Rounding of s turns the tool by as much as it turns on the way.
            atol = 1e-12 + 1e-15 * float(np.linalg.norm(path.derivatives(np.array([waypoint.s])).w))
            assert_allclose(R, waypoint.R, atol=atol)


@pytest.mark.parametrize("gap", [2e-9, 1e-5, 9e-4])
def test_a_gap_before_a_curve_is_joined_by_a_line_however_short(gap: float) -> None:
    frame = {"frame": {"position": [gap, 0.0, 0.0]}}
    wave = {"type": "sinusoid", "length": 0.1, "amplitude": 0.02, "wavelength": 0.05}
    wave |= {"orientation": "free", **frame}
    path = of_segments(wave, start=Pose(None, np.zeros(3)))
    assert len(path.pieces) == 2
    assert path.begins[1] == pytest.approx(gap, rel=1e-6)
    before, after = path.derivatives(path.begins[1] * np.array([0.999, 1.001])).p
    assert np.linalg.norm(after - before) <= 0.01 * gap
