"""Rounded corners: within their radius, smooth, and as far off as they say."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from ikplan import InvalidRequest
from ikplan.path import Pose
from ikplan.path.rotation.so3 import angle_between, exp

from .requests import legs, of_segments, pose, random_poses, seeds, through

ORIGIN = Pose(np.eye(3), np.zeros(3))
L_SHAPE = [pose([0.2, 0, 0], [0, 0, 0.4]), pose([0.2, 0.2, 0], [0, 0.7, 0.4])]


def line(position: list[float], rotvec: list[float] | None = None, **more: Any) -> dict[str, Any]:
    return {"type": "line", "to": pose(position, rotvec), **more}


@settings(max_examples=12, deadline=None)
@given(seeds, st.floats(0.005, 0.1))
def test_a_blend_keeps_within_its_radius_and_tells_its_deviation(seed: int, radius: float) -> None:
    poses = random_poses(seed, 5)
    points = np.array([p["position"] for p in poses])
    steps = np.diff(points, axis=0)
    assume(np.linalg.norm(steps, axis=1).min() > 2.0 * radius)
    exact, path = through(poses, "line", None), through(poses, "line", None, blend=radius)
    assert len(path.corners) == 0
    assert [c.waypoint for c in path.corner_list] == [1, 2, 3]
    along = np.linspace(0.0, path.length, 4001)
    dense = path.poses(along)
    for corner in path.corner_list:
        assert corner.waypoint is not None
        waypoint = path.waypoints[corner.waypoint]
        assert waypoint.R is not None
        assert not waypoint.exact
        assert waypoint.s == corner.s
        # Nearest to the corner, and by how much: against every pose of the path around it.
        around = np.abs(along - corner.s) <= 2.0 * radius
        distance = np.linalg.norm(dense[1][around] - waypoint.p, axis=1)
        assert corner.deviation <= distance.min() + 1e-12
        assert corner.deviation > distance.min() - path.length / 4000
        R, p = path.pose(corner.s)
        assert np.linalg.norm(p - waypoint.p) == pytest.approx(corner.deviation, abs=1e-12)
        assert angle_between(R, waypoint.R) == pytest.approx(corner.rotation, abs=1e-10)
        assert corner.blend == radius
        assert 0.0 < corner.deviation < radius
    # Away from the corners by the radius, the path is the exact one.
    _, p = dense
    to_corners = np.linalg.norm(p[:, None] - points[1:-1], axis=2).min(axis=1)
    _, q = exact.poses(np.linspace(0.0, exact.length, 4001))
    away = p[to_corners > radius * (1.0 + 1e-6)][::20]
    gaps = np.linalg.norm(away[:, None] - q, axis=2).min(axis=1)
    assert gaps.max(initial=0.0) < exact.length / 4000


@pytest.mark.parametrize("rounded", ["lines", "line to arc", "arc to spline", "sawtooth"])
def test_a_blend_joins_with_the_same_direction_curvature_and_angular_rate(rounded: str) -> None:
    arc = {"type": "arc", "centre": [0.2, 0.3, 0.0], "angle": 1.5, "axis": [0.2, 0, 1],
           "orientation": "follow"}  # fmt: skip
    kinds: dict[str, list[dict[str, Any]]] = {
        "lines": [line([0.2, 0, 0], [0, 0, 0.4], blend=0.05), line([0.2, 0.2, 0], [0, 0.7, 0.4])],
        "line to arc": [line([0.1, 0, 0.1], [0, 0, 0.4], blend=0.05), arc],
        "arc to spline": [
            {**arc, "blend": 0.03}, {"type": "spline", "through": random_poses(4, 4)},
        ],
        "sawtooth": [
            {"type": "sawtooth", "length": 0.4, "height": 0.1, "teeth": 2, "fall": 0.1,
             "blend": 0.01},
        ],
    }  # fmt: skip
    path = of_segments(*kinds[rounded], start=ORIGIN)
    assert len(path.corners) == 0
    joints = path.begins[1:-1]
    h = 1e-10
    a, b = path.derivatives(joints - h), path.derivatives(joints + h)
    scale = 1.0 + np.abs(b.bend).max()
    assert_allclose(a.v, b.v, atol=1e-9 * scale)
    assert_allclose(a.w, b.w, atol=1e-7 * scale)
    assert_allclose(a.bend, b.bend, atol=1e-5 * scale)


def test_a_blend_of_a_right_angle_is_symmetric() -> None:
    path = through(L_SHAPE, "line", ORIGIN, blend=0.05)
    (corner,) = path.corner_list
    straight = path.begins[1]
    assert straight == pytest.approx(0.15)
    assert path.length - path.begins[2] == pytest.approx(0.15)
    assert corner.s == pytest.approx(0.5 * path.length)
    _, p = path.pose(corner.s)
    assert_allclose(p, [p[0], 0.2 - p[0], 0.0], atol=1e-12)
    # The quintic is at (P0 + 5 P1 + 10 P2 + 10 P3 + 5 P4 + P5) / 32 half way: 5/16 of the radius
    # along either side, with control points at 1, 0.6 and 0.2 of it.
    assert corner.deviation == pytest.approx(math.sqrt(2.0) * 0.05 * (1 + 3 + 2) / 32.0)


def test_the_orientation_goes_over_from_one_turning_to_the_other() -> None:
    path = through(L_SHAPE, "line", ORIGIN, blend=0.05)
    (corner,) = path.corner_list
    first, blend, last = path.pieces
    assert_allclose(blend.pose(0.0)[0], exp(np.array([0, 0, 0.3])), atol=1e-12)
    assert_allclose(blend.pose(0.0)[0], first.pose(1.0)[0], atol=1e-12)
    assert_allclose(blend.pose(1.0)[0], last.pose(0.0)[0], atol=1e-12)
    assert corner.rotation < 0.05
    # C2: angular acceleration, 0 on lines, is continuous too.
    h = 1e-5
    for joint in path.begins[1:-1]:
        w = path.derivatives(np.array([joint - h, joint, joint + h])).w
        assert np.linalg.norm(w[2] - w[1]) / h < 0.2
        assert np.linalg.norm(w[1] - w[0]) / h < 0.2


def test_radii_that_overlap_are_refused_with_the_largest_that_fits() -> None:
    square = [pose([0.1, 0, 0]), pose([0.1, 0.1, 0]), pose([0, 0.1, 0])]
    with pytest.raises(InvalidRequest, match=r"is 0\.05 m") as caught:
        through(square, "line", ORIGIN, blend=0.0501)
    assert caught.value.field == "path.blend"
    assert len(through(square, "line", ORIGIN, blend=0.05).corners) == 0
    parts = [line([0.1, 0, 0], blend=0.08), line([0.1, 0.1, 0], blend=0.03), line([0, 0.1, 0])]
    with pytest.raises(InvalidRequest, match="largest radius that fits") as caught:
        of_segments(*parts, start=ORIGIN)
    fits = float(caught.value.allowed.removeprefix("at most "))
    parts[0]["blend"] = fits
    path = of_segments(*parts, start=ORIGIN)
    assert fits == pytest.approx(0.07)
    assert [c.blend for c in path.corner_list] == [fits, 0.03]


def test_a_blend_longer_than_its_segment_is_refused_with_the_length() -> None:
    with pytest.raises(InvalidRequest, match=r"is 0\.1 m") as caught:
        of_segments(line([0.1, 0, 0], blend=0.2), line([0.1, 0.5, 0]), start=ORIGIN)
    assert caught.value.field == "path.segments[0].blend"
    assert caught.value.allowed == "at most 0.1"


def test_a_blend_leaves_the_poses_of_a_spline_on_the_path() -> None:
    spline = {"type": "spline", "through": random_poses(1, 4), "blend": 0.5}
    with pytest.raises(InvalidRequest, match="largest radius that fits") as caught:
        of_segments(spline, line([0, 0, 1]), start=ORIGIN)
    fits = float(caught.value.allowed.removeprefix("at most "))
    path = of_segments({**spline, "blend": fits * 0.999}, line([0, 0, 1]), start=ORIGIN)
    assert [w.exact for w in path.waypoints] == [True, True, True, False, True]


@pytest.mark.parametrize(
    ("segments", "words"),
    [
        ([line([0.1, 0, 0], blend=0.02)], "no corner"),
        ([line([0.1, 0, 0], blend=0.02), line([0, 0, 0])], "turns back"),
        (
            [line([0.1, 0, 0], [0, 0, 0], blend=0.02), line([0.1, 0, 0], [0, 0, 1])],
            "turns on the spot",
        ),
        ([line([0.1, 0, 0], blend=0.02), {"type": "move", "q": [0.0] * 6}], "no corner"),
        (
            [line([0.1, 0, 0], [0, 0, 2.9], blend=0.09), line([0.1, 0.1, 0], [0, 2.9, 0])],
            "largest radius",
        ),
    ],
)
def test_corners_that_cannot_be_rounded_are_refused_if_asked_for(
    segments: list[dict[str, Any]], words: str
) -> None:
    with pytest.raises(InvalidRequest, match=words) as caught:
        legs({"segments": segments}, ORIGIN)
    assert caught.value.field == "path.segments[0].blend"


def test_the_blend_of_the_path_leaves_such_corners_exact() -> None:
    back = [pose([0.1, 0, 0]), pose([0, 0, 0]), pose([0, 0.1, 0])]
    path = through(back, "line", ORIGIN, blend=0.01)
    assert_allclose(path.corners, [0.1])
    assert [c.blend for c in path.corner_list] == [0.0, 0.01]
    straight = [pose([0.1, 0, 0]), pose([0.2, 0, 0])]
    assert through(straight, "line", ORIGIN, blend=0.01).corner_list == ()


def test_a_segment_has_its_own_blend_or_that_of_the_path() -> None:
    parts = [line([0.1, 0, 0], blend=0.0), line([0.1, 0.1, 0]), line([0, 0.1, 0])]
    path = of_segments(*parts, start=ORIGIN, blend=0.02)
    assert [(c.blend, c.stops) for c in path.corner_list] == [(0.0, True), (0.02, False)]
    assert_allclose(path.corners, [0.1])


def hull(radius: float, back: float) -> np.ndarray:
    """Control points of the quintic from an arc about (0, radius) to a line along y, shape (6, 2).

    It begins and ends ``back`` from the corner at the origin, where the arc comes in along x.
    With the derivatives 2 back t and (2 back)^2 k by its parameter, t the direction and k the
    curvature, the points are at 2 back / 5 and, bent by (2 back)^2 k / 20, at 4 back / 5.
    """
    angle = back / radius
    p = radius * np.array([-math.sin(angle), 1.0 - math.cos(angle)])
    t = np.array([math.cos(angle), -math.sin(angle)])
    bend = np.array([math.sin(angle), math.cos(angle)]) / radius
    own = [p, p + 0.4 * back * t, p + 0.8 * back * t + 0.2 * back**2 * bend]
    return np.array([*own, [0.0, 0.2 * back], [0.0, 0.6 * back], [0.0, back]])


@settings(max_examples=60, deadline=None)
@given(st.floats(0.02, 0.2), st.floats(0.3, 5.5), st.floats(0.3, 1.0))
@example(0.05, 5.0, 0.9)
def test_a_blend_is_as_long_as_its_control_points_are_within_its_ball(
    rho: float, angle: float, share: float
) -> None:
    """The hull of the control points has the curve in it: with them it is within the ball."""
    radius = share * rho * angle
    arc = {"type": "arc", "centre": [0, rho, 0], "axis": [0, 0, 1], "angle": angle,
           "blend": radius, "orientation": "free"}  # fmt: skip
    begin = rho * np.array([-math.sin(angle), 1.0 - math.cos(angle), 0.0])
    assume(np.linalg.norm(begin) > 1e-3)
    path = of_segments(arc, line([0.0, 1.2, 0.0]), start=Pose(np.eye(3), begin))
    (corner,) = path.corner_list
    assert corner.blend == radius
    back = 1.2 - (path.length - path.begins[-2])
    tries = [radius * 0.8**k for k in range(40)]
    within = [np.linalg.norm(hull(rho, x), axis=1).max() <= radius * (1.0 + 1e-9) for x in tries]
    assert back == pytest.approx(tries[within.index(True)], rel=1e-6)
    dense = np.linspace(path.begins[-3], path.begins[-2], 400)
    assert np.linalg.norm(path.poses(dense)[1], axis=1).max() <= radius * (1.0 + 1e-9)
