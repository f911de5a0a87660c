"""Curves near points: within a ball or a box of each, as straight as that allows."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from ikplan.smoothing import clusters_of, fit_within
from ikplan.smoothing.box_fit_kernels import minimax_fit

Array = NDArray[np.float64]


def arc(count: int, noise: float, seed: int = 2) -> tuple[Array, Array]:
    """Points of half a circle of radius 1 with noise, and the arc length of each."""
    rng = np.random.default_rng(seed)
    u = np.linspace(0.0, np.pi, count)
    points = np.stack([np.cos(u), np.sin(u), 0.0 * u], axis=1)
    points[1:-1] += rng.uniform(-noise, noise, size=(count - 2, 3))
    return u, points


@pytest.mark.parametrize("together", [None, [3], [1, 2]])
@pytest.mark.parametrize("noise", [0.0, 1e-3, 4e-3])
def test_a_curve_passes_each_point_within_its_box_or_ball(
    together: list[int] | None, noise: float
) -> None:
    u, points = arc(200, noise)
    half = np.full(points.shape, 5e-3)
    curve = fit_within(u, points, half, together)
    off = (curve(u) - points) / half
    sizes = [1, 1, 1] if together is None else together
    first = np.cumsum([0, *sizes[:-1]])
    assert np.sqrt(np.add.reduceat(off * off, first, axis=1)).max() <= 1.0 + 1e-9
    np.testing.assert_allclose(curve([0.0, np.pi]), points[[0, -1]], rtol=0.0, atol=1e-15)


def test_a_curve_near_a_noisy_circle_bends_about_as_the_circle() -> None:
    u, points = arc(300, 2e-3)
    curve = fit_within(u, points, np.full(points.shape, 6e-3), [3])
    inner = np.linspace(0.3, np.pi - 0.3, 200)
    bend = np.linalg.norm(curve(inner, 2), axis=1)
    assert bend.max() < 1.5
    assert bend.min() > 0.5


def test_few_points_that_cannot_be_met_do_not_bend_the_curve_elsewhere() -> None:
    """One point of many is off by far more than what is allowed: the curve goes there and back."""
    u = np.linspace(0.0, 1.0, 401)
    points = np.outer(u, [1.0, 0.0])
    points[200, 1] = 0.05
    curve = fit_within(u, points, np.full(points.shape, 1e-3))
    assert np.abs(curve(u) - points).max() <= 1e-3 * (1.0 + 1e-9)
    away = np.abs(u - 0.5) > 0.15
    assert np.abs(curve(u[away], 2)[:, 1]).max() < 1e-2 * np.abs(curve(u, 2)[:, 1]).max()


def test_least_squares_are_those_of_a_dense_solution() -> None:
    rng = np.random.default_rng(6)
    u, n = np.sort(rng.uniform(0.0, 1.0, 60)), 60
    u[0], u[-1] = 0.0, 1.0
    y, m = rng.normal(size=(n, 2)), 12
    knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, m - 2), np.ones(3)])
    design = BSpline.design_matrix(u, knots, 3).toarray()
    first = np.array([np.flatnonzero(row).min(initial=m - 4) for row in design])
    first = np.minimum(first, m - 4)
    values = np.take_along_axis(design, first[:, None] + np.arange(4), axis=1)
    root = rng.normal(size=(m, m))
    bend = np.triu(np.tril(root @ root.T, 3), -3) + 60.0 * np.eye(m)
    bands = np.array([[bend[i + k, i] if i + k < m else 0.0 for k in range(4)] for i in range(m)])
    group = np.zeros(2, dtype=np.int64)
    found, _ = minimax_fit(first, values, bands, y, np.full((n, 2), 1.0), group, 0.3, 1)
    # The first and the last coefficient are the end points, the others solve the normal equations.
    normal, right = design.T @ design + 0.3 * bend, design.T @ y
    inner = slice(1, m - 1)
    ends = normal[inner][:, [0, -1]] @ y[[0, -1]]
    asked = np.linalg.solve(normal[inner, inner], right[inner] - ends)
    np.testing.assert_allclose(found[inner], asked, rtol=1e-10, atol=1e-12)
    np.testing.assert_array_equal(found[[0, -1]], y[[0, -1]])


def test_whatever_is_in_the_ball_of_a_cluster_is_in_that_of_each_of_its_points() -> None:
    rng = np.random.default_rng(9)
    points = np.cumsum(rng.normal(scale=0.1, size=(80, 3)), axis=0)
    clusters = clusters_of(points, np.ones(3), [3])
    assert len(clusters.u) < len(points)
    for point, k in zip(points[1:-1], clusters.of_point[1:-1], strict=True):
        if k in (0, clusters.of_point[-1]):
            continue
        away = rng.normal(size=(50, 3))
        away /= np.linalg.norm(away, axis=1)[:, None]
        places = clusters.middle[k] + clusters.half_width[k] * away
        assert np.linalg.norm(places - point, axis=1).max() <= 1.0 + 1e-9
