"""Shapes of coal, held to those with the hulls of SciPy."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from ikplan.scene.body import ConvexPiece
from ikplan.scene.coal_pieces import coal_piece

Array = NDArray[np.float64]


def with_its_hull(points: Array) -> Any:
    """The convex hull as a shape of coal, its faces those of Qhull."""
    hull = ConvexHull(points)
    number = {int(vertex): k for k, vertex in enumerate(hull.vertices)}
    vertices, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in hull.vertices:
        vertices.append(points[vertex])
    for face in hull.simplices:
        triangles.append(coal.Triangle(*(number[int(vertex)] for vertex in face)))
    return coal.Convex(vertices, triangles)


def distance(first: Any, second: Any, pose: Any) -> float:
    """Their signed distance."""
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    result = coal.DistanceResult()
    return float(coal.distance(first, coal.Transform3s(), second, pose, request, result))


def ring(count: int, rng: np.random.Generator) -> Array:
    """The corners of a prism, count at each end."""
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    flat = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
    return np.vstack([flat, flat + np.array([0.0, 0.0, rng.uniform(0.5, 2.0)])])


def box(rng: np.random.Generator) -> Array:
    """The corners of a box."""
    grid = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners: Array = grid * rng.uniform(0.3, 1.0, 3)
    return corners


@pytest.mark.parametrize("count", [4, 5, 8, 12, 24, 32, 33, 64])
def test_a_shape_of_few_points_is_as_far_from_others_as_their_hull(count: int) -> None:
    rng = np.random.default_rng(count)
    kinds = [
        rng.normal(size=(count, 3)),  # many of them within the hull
        ring(max(count // 2, 3), rng),
        box(rng),
    ]
    apart, within = 0, 0
    for round_ in range(60):
        points, others = kinds[round_ % 3], rng.normal(size=(10, 3))
        pose = coal.Transform3s(
            np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3) * (0.4 + round_ % 4)
        )
        other = with_its_hull(others)
        found = distance(coal_piece(ConvexPiece(points, 0.0)).shape, other, pose)
        expected = distance(with_its_hull(points), other, pose)
        assert found == pytest.approx(expected, abs=1e-9)
        apart, within = apart + (expected > 0.1), within + (expected < -0.1)
    assert apart > 5
    assert within > 5
