"""Corners rounded within the tolerance: passed without a stop, near the sharp path."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.typing import NDArray

from ikplan.documents import content_hash, parse
from ikplan.documents.path import PathRequest
from ikplan.path import Pose, ToolLeg, ToolPath, legs_of
from ikplan.path.rotation.so3 import angle_between

from .requests import of_segments, pose, random_poses, seeds, through

ORIGIN = Pose(np.eye(3), np.zeros(3))
TOLERANCE = {"position": 1e-3, "orientation": 1e-2}
Array = NDArray[np.float64]


def rounded(poses: list[dict[str, Any]], start: Pose | None = None, **more: Any) -> ToolPath:
    return through(poses, "line", start, corners="tolerance", **more)


def off_the_sharp_path(path: ToolPath, sharp: ToolPath) -> tuple[float, float]:
    """Largest distance and angle of a path from the places of the sharp one nearest to it."""
    R, p = path.poses(np.linspace(0.0, path.length, 1501))
    R_sharp, p_sharp = sharp.poses(np.linspace(0.0, sharp.length, 12001))
    nearest = [int(np.argmin(np.linalg.norm(p_sharp - point, axis=1))) for point in p]
    distance = np.linalg.norm(p - p_sharp[nearest], axis=1)
    return float(distance.max()), float(angle_between(R, R_sharp[nearest]).max())


@settings(max_examples=10, deadline=None)
@given(seeds)
def test_rounded_corners_are_near_the_sharp_path_and_not_stopped_at(seed: int) -> None:
    poses = random_poses(seed, 5)
    sharp = through(poses, "line", None, tolerance=TOLERANCE)
    path = rounded(poses, tolerance=TOLERANCE)
    assert len(sharp.corners) == 3
    assert len(path.corners) == 0
    distance, angle = off_the_sharp_path(path, sharp)
    step = sharp.length / 12000
    assert 0.0 < distance <= 0.4e-3 + step
    # The nearest of finitely many places is up to half a step along the turning path.
    rate = max(np.linalg.norm(sharp.derivatives(np.linspace(0, sharp.length, 99)).w, axis=1))
    assert angle <= 0.4e-2 + rate * step


def test_a_corner_between_lines_is_cut_by_the_share_of_the_tolerance() -> None:
    corner = {"type": "line", "to": pose([0.2, 0.0, 0.0])}
    end = {"type": "line", "to": pose([0.2, 0.2, 0.0])}
    path = of_segments(corner, end, start=ORIGIN, corners="tolerance", tolerance={"position": 1e-3})
    (found,) = path.corner_list
    # A quintic of reach r about a right angle passes the corner at 3/16 r sqrt(2).
    assert found.deviation == pytest.approx(0.4e-3, rel=1e-6)
    assert found.blend == pytest.approx(0.4e-3 * 16.0 / 3.0 / np.sqrt(2.0), rel=1e-6)


@pytest.mark.parametrize(
    "ask", [{"corners": "exact"}, {"blend": 0.0}, {"blend": 0.0, "corners": "tolerance"}]
)
def test_exact_corners_are_stopped_at(ask: dict[str, Any]) -> None:
    path = through(random_poses(3, 5), "line", None, **{"corners": "tolerance", **ask})
    assert len(path.corners) == 3


def test_a_segment_may_ask_for_its_own_corner() -> None:
    segments = [
        {"type": "line", "to": pose(p), **more}
        for p, more in (
            ([0.2, 0.0, 0.0], {"blend": 0.0}),
            ([0.2, 0.2, 0.0], {}),
            ([0.0, 0.2, 0.0], {"blend": 0.05}),
            ([0.0, 0.5, 0.0], {}),
        )
    ]
    path = of_segments(*segments, start=ORIGIN, corners="tolerance", tolerance={"position": 1e-3})
    exact, rounded, asked = path.corner_list
    assert (exact.stops, rounded.stops, asked.stops) == (True, False, False)
    assert rounded.deviation == pytest.approx(0.4e-3, rel=1e-6)
    assert asked.blend == 0.05


@pytest.mark.parametrize("stopping", ["back", "spot", "free on one side"])
def test_corners_that_cannot_be_rounded_are_stopped_at(stopping: str) -> None:
    there = pose([0.2, 0.0, 0.0], [0.0, 0.0, 0.0])
    then = {
        "back": pose([0.1, 0.0, 0.0], [0.0, 0.0, 0.0]),
        "spot": pose([0.2, 0.0, 0.0], [0.0, 0.0, 0.5]),
        "free on one side": pose([0.2, 0.2, 0.0]),
    }[stopping]
    path = rounded([there, then], ORIGIN)
    assert path.corners == pytest.approx([0.2])


def circle(count: int, step: float, noise: float = 0.0) -> list[dict[str, Any]]:
    """Points of a circle a step apart whose corners turn by 2.1 mrad, of one orientation."""
    rng = np.random.default_rng(7)
    radius = step / 2.1e-3
    angle = np.arange(count) * 2.1e-3
    points = radius * np.stack([np.sin(angle), 1.0 - np.cos(angle), np.zeros(count)], axis=1)
    points[1:-1] += rng.uniform(-noise, noise, size=(count - 2, 3))
    return [pose(p, [0.0, 0.0, 0.0]) for p in points]


@pytest.mark.parametrize("noise", [0.0, 2e-5])
def test_a_dense_path_is_one_smooth_curve_within_the_tolerance(noise: float) -> None:
    poses = circle(400, 0.156e-3, noise)
    sharp = through(poses, "line", None)
    path = rounded(poses)
    assert len(path.corners) == 0
    assert [w.row for w in path.waypoints] == list(range(400))
    distance, angle = off_the_sharp_path(path, sharp)
    assert distance <= 0.4e-4
    assert angle <= 1e-7
    for waypoint in path.waypoints:
        assert np.linalg.norm(path.pose(waypoint.s)[1] - waypoint.p) <= 0.4e-4
    # The curvature is about that of the circle: rounded one by one, it would be twice as much at
    # each corner, and of the points with noise, hundreds of times.
    places = np.linspace(0.02 * path.length, 0.98 * path.length, 301)
    bend = np.linalg.norm(path.derivatives(places).bend, axis=1)
    assert bend.max() < 1.4 * 2.1e-3 / 0.156e-3
    assert np.array_equal(path.poses(np.zeros(1))[1][0], sharp.poses(np.zeros(1))[1][0])


def test_a_dense_path_that_turns_keeps_its_orientations() -> None:
    angle = np.linspace(0.0, 0.8, 200)
    poses = [
        pose([0.1 * np.sin(a), 0.1 - 0.1 * np.cos(a), 0.0], [0.3 * np.sin(2 * a), 0.2 * a, 0.5 * a])
        for a in angle
    ]
    sharp = through(poses, "line", None)
    path = rounded(poses)
    assert len(path.corners) == 0
    distance, turned = off_the_sharp_path(path, sharp)
    assert distance <= 0.4e-4
    assert turned <= 0.4e-3 + 1e-4
    s = np.linspace(0.0, path.length, 57)[1:-1]
    h = 1e-6
    # The angular rate is the derivative of the orientation.
    ahead, behind = path.poses(s + h)[0], path.poses(s - h)[0]
    rate = np.linalg.norm(path.derivatives(s).w, axis=1)
    np.testing.assert_allclose(angle_between(behind, ahead) / (2 * h), rate, rtol=1e-4, atol=1e-5)


def test_the_id_of_a_request_says_which_corners_are_asked_for() -> None:
    document = {"waypoints": random_poses(1, 3), "interpolation": "line"}
    hashes = {
        content_hash(parse(PathRequest, {**document, **more}))
        for more in ({}, {"corners": "exact"}, {"blend": 0.0}, {"blend": 0.01})
    }
    assert len(hashes) == 4
    default = content_hash(parse(PathRequest, document))
    assert default == content_hash(parse(PathRequest, {**document, "corners": "tolerance"}))


def test_a_curve_that_is_nearest_to_its_corner_at_its_end_is_rounded() -> None:
    """A tooth without a falling side, then a small circle: found by random requests."""
    document = json.loads((Path(__file__).parent / "corner_at_the_end.json").read_text())
    (leg,) = legs_of(parse(PathRequest, document), ORIGIN, lambda q: (np.eye(3), q[:3]))
    assert isinstance(leg, ToolLeg)
    assert leg.path.length > 0.0
    assert np.isfinite(leg.path.poses(np.linspace(0.0, leg.path.length, 500))[1]).all()
