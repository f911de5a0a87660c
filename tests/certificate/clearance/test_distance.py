"""The distance kernel: closed forms, invariances, and coal."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.collision.drawing import box, draw_hull, rotation
from benchmarks.collision.queries import compare, draw_pieces, kernel_distances
from ikplan.certificate.clearance.gjk import piece_distance, scratch
from ikplan.certificate.clearance.penetration import depth_at_most
from ikplan.certificate.clearance.shapes import bounding_sphere
from ikplan.scene.body import ConvexPiece

Array = NDArray[np.float64]
EYE = np.eye(3)[None]


def distance(a: ConvexPiece, b: ConvexPiece, at: Array, turn: Array | None = None) -> Array:
    """Lower and upper bound with the second piece at a place."""
    R = EYE if turn is None else turn[None]
    found: Array = kernel_distances([a, b], np.array([[0, 1]]), R, at[None])[0]
    return found


def query(
    a: Array, b: Array, needed: float = np.inf, enough: float = -1.0
) -> tuple[float, float, Array]:
    """Bounds and points of two hulls in one frame."""
    xyz = np.ascontiguousarray(np.concatenate([a, b]).T)
    start = np.array([0, len(a), len(a) + len(b)])
    space = scratch()
    v = a.mean(axis=0) - b.mean(axis=0)
    R, p = np.eye(3)[None], np.zeros((1, 3))
    bounds = piece_distance(xyz, start, 0, 1, R, p, 0, 0, needed, enough, v, space)
    return *bounds, space.nearest


def test_spheres_are_as_far_apart_as_their_centres_less_their_radii() -> None:
    a, b = ConvexPiece(np.zeros((1, 3)), 0.3), ConvexPiece(np.zeros((1, 3)), 0.2)
    for at in (np.array([1.0, 0.0, 0.0]), np.array([0.3, -0.4, 1.2])):
        np.testing.assert_allclose(distance(a, b, at), np.linalg.norm(at) - 0.5, atol=1e-12)


def test_crossed_capsules_are_apart_by_the_distance_of_their_lines() -> None:
    a = ConvexPiece(np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), 0.1)
    b = ConvexPiece(np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]), 0.05)
    np.testing.assert_allclose(distance(a, b, np.array([0.3, 0.2, 0.7])), 0.55, atol=1e-12)


def test_parallel_capsules_are_apart_by_the_distance_of_their_axes() -> None:
    a = ConvexPiece(np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), 0.1)
    np.testing.assert_allclose(distance(a, a, np.array([0.5, 0.3, 0.4])), 0.3, atol=1e-9)


@pytest.mark.parametrize("thin", [1.0, 1e-3, 1e-6])
def test_boxes_along_the_axes_are_apart_by_their_gaps(thin: float) -> None:
    a, b = box(np.zeros(3), np.array([1.0, 1.0, thin])), box(np.zeros(3), np.array([0.5, 0.2, 0.4]))
    half = (np.array([1.0, 1.0, thin]) + np.array([0.5, 0.2, 0.4])) / 2
    for gap in (
        np.array([0.1, 0.2, 0.3]),
        np.array([-1.0, 0.3, 0.1]),
        np.array([-1.0, -1.0, 1e-4]),
    ):
        expected = np.linalg.norm(np.maximum(gap, 0.0))
        np.testing.assert_allclose(distance(a, b, half + gap), expected, atol=1e-9)


def test_touching_and_overlapping_hulls_have_no_positive_lower_bound() -> None:
    a = box(np.zeros(3), np.ones(3))
    for at in ([1.0, 0.2, 0.1], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.9, 0.9, 0.9], [1.0, 1.0, 0.0]):
        lower, upper = distance(a, a, np.array(at))
        assert lower <= 0.0
        assert upper <= 1e-9


def test_a_hull_inside_another_touches_it() -> None:
    assert (
        distance(box(np.zeros(3), np.ones(3)), box(np.zeros(3), np.full(3, 0.1)), np.full(3, 0.2))[
            0
        ]
        <= 0
    )


def test_the_kernel_agrees_with_coal() -> None:
    study = compare(6000, seed=3)
    assert study.touching > 500
    assert study.missed == 0
    assert study.above <= 5e-6
    assert study.below <= 5e-6
    assert study.gap <= 1e-8


def test_distances_do_not_change_under_rigid_motion_or_swap() -> None:
    rng = np.random.default_rng(7)
    for _ in range(200):
        a, b = draw_hull(rng, 0.3).points, draw_hull(rng, 0.2).points + rng.uniform(-0.6, 0.6, 3)
        lower, upper, nearest = query(a, b)
        R, p = rotation(rng), rng.uniform(-2.0, 2.0, 3)
        for other in (query(a @ R.T + p, b @ R.T + p), query(b, a)):
            np.testing.assert_allclose([other[0], other[1]], [lower, upper], atol=1e-8)
        if lower > 1e-6:
            np.testing.assert_allclose(np.linalg.norm(nearest[0] - nearest[1]), upper, atol=1e-12)


def test_bounds_are_kept_where_the_kernel_stops_early() -> None:
    rng = np.random.default_rng(8)
    stopped = 0
    for _ in range(300):
        a, b = draw_hull(rng, 0.3).points, draw_hull(rng, 0.2).points + rng.uniform(-0.6, 0.6, 3)
        lower, upper, _ = query(a, b)
        needed, enough = float(rng.uniform(0.0, 0.5)), float(rng.uniform(0.0, 0.5))
        early_lower, early_upper, nearest = query(a, b, needed, enough)
        assert early_lower <= upper + 1e-12
        assert early_upper >= max(lower, 0.0) - 1e-12
        assert early_upper >= np.linalg.norm(nearest[0] - nearest[1]) - 1e-12
        exact = early_upper - early_lower <= 1e-8 or early_upper == 0.0
        assert early_lower > needed or early_upper <= enough or exact
        stopped += not exact
    assert stopped > 50


def test_the_points_lie_on_the_hulls() -> None:
    rng = np.random.default_rng(9)
    for _ in range(50):
        a, b = draw_hull(rng, 0.3).points, draw_hull(rng, 0.2).points + np.array([0.7, 0.0, 0.0])
        nearest = query(a, b)[2]
        for hull, point in zip((a, b), nearest, strict=True):
            assert query(hull, point[None])[1] <= 1e-7


def test_the_bounding_sphere_holds_all_points_and_is_centred_inside() -> None:
    rng = np.random.default_rng(10)
    for piece in draw_pieces(rng, 40):
        centre, size = bounding_sphere(piece.points)
        assert np.linalg.norm(piece.points - centre, axis=1).max() <= size + 1e-12
        assert query(piece.points, centre[None])[1] <= 1e-9
        assert size <= np.ptp(piece.points, axis=0).max() * np.sqrt(3) / 2 * 1.05 + 1e-12


def test_the_depth_of_boxes_is_their_least_overlap() -> None:
    a = box(np.zeros(3), np.ones(3)).points
    for shift, depth in ((np.array([0.7, 0.2, 0.1]), 0.3), (np.array([0.1, -0.2, 0.95]), 0.05)):
        found = depth_at_most(a, a + shift, 0.0)
        assert depth - 1e-12 <= found <= depth + 1e-4
        assert depth_at_most(a, a + shift, 0.1) == pytest.approx(found + 0.1)
    assert depth_at_most(a, a + 2.0, 0.1) == 0.0
