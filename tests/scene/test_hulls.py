"""Few points and a radius enclose many points, whatever these are."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ikplan.documents.shape import (
    BoxShape,
    CapsuleShape,
    ConvexShape,
    CylinderShape,
    PointsShape,
    Shape,
    SphereShape,
)
from ikplan.scene.body import Body, ConvexPiece
from ikplan.scene.contacts import COAL_TOLERANCE, Contacts
from ikplan.scene.hulls import distance_beyond, enclosing_points, hull_of
from ikplan.scene.shapes import enclose

Array = NDArray[np.float64]
STILL = (np.eye(3)[None], np.zeros((1, 3)))


def support(points: Array, radius: float, directions: Array) -> Array:
    """How far a piece reaches along directions."""
    reach: Array = (points @ directions.T).max(axis=0) + radius
    return reach


def directions(count: int = 2_000) -> Array:
    d = np.random.default_rng(5).normal(size=(count, 3))
    unit: Array = d / np.linalg.norm(d, axis=1)[:, None]
    return unit


def reaches_around(points: Array, kept: Array, radius: float) -> bool:
    """Whether a piece reaches as far as the points along every direction tried."""
    d = directions()
    return bool(np.all(support(kept, radius, d) >= (points @ d.T).max(axis=0) - 1e-12))


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 400),
    stretch=st.sampled_from(
        [(1, 1, 1), (1, 1, 0), (1, 0, 0), (0, 0, 0), (1, 1, 1e-7), (5, 1e-3, 1)]
    ),
    most=st.integers(8, 64),
)
def test_enclosing_points_enclose(
    seed: int, count: int, stretch: tuple[float, float, float], most: int
) -> None:
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    points = rng.normal(size=(count, 3)) * stretch @ turn + rng.normal(size=3)
    kept, radius, excess = enclosing_points(points, most)
    assert reaches_around(points, kept, radius)
    assert 0.0 <= radius <= excess + 1e-15
    d = directions()
    beyond = support(kept, radius, d) - (points @ d.T).max(axis=0)
    assert beyond.max() <= excess + 1e-9


def test_a_large_cloud_on_a_sphere_is_thinned_soon() -> None:
    points = np.random.default_rng(1).normal(size=(5_000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    began = time.process_time()
    kept, radius, _ = enclosing_points(points, 128)
    assert time.process_time() - began < 10.0
    assert len(kept) <= 128
    assert reaches_around(points, kept, radius)
    assert radius < 0.06


def test_the_distance_beyond_a_box_is_that_of_the_closed_form() -> None:
    half = np.array([0.5, 1.0, 2.0])
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    hull = hull_of(corners)
    assert hull is not None
    points = np.random.default_rng(2).uniform(-3, 3, size=(3_000, 3))
    exact = np.linalg.norm(np.maximum(np.abs(points) - half, 0.0), axis=1)
    found = distance_beyond(points, hull)
    assert np.all(found >= exact - 1e-12)  # from above
    np.testing.assert_allclose(found, exact, atol=1e-12)


def surface(shape: Shape, rng: np.random.Generator) -> Array:
    """Points of a shape."""
    u = rng.normal(size=(2_000, 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    angle, z = rng.uniform(0, 2 * np.pi, 2_000), rng.uniform(-0.5, 0.5, 2_000)
    if isinstance(shape, BoxShape):
        return rng.uniform(-0.5, 0.5, size=(2_000, 3)) * shape.size
    if isinstance(shape, SphereShape):
        return u * shape.radius
    if isinstance(shape, CylinderShape):
        ring = [shape.radius * np.cos(angle), shape.radius * np.sin(angle), z * shape.length]
        return np.column_stack(ring)
    if isinstance(shape, CapsuleShape):
        return u * shape.radius + np.outer(z * shape.length, [0, 0, 1])
    assert isinstance(shape, ConvexShape | PointsShape)
    corners = np.array(shape.points)
    if isinstance(shape, PointsShape):
        return corners[rng.integers(0, len(corners), 2_000)] + u * shape.radius
    shares: Array = rng.dirichlet(np.ones(len(corners)), 2_000) @ corners
    return shares


CLOUD = np.random.default_rng(3).uniform(-1, 1, size=(2_000, 3)).tolist()


@pytest.mark.parametrize(
    "shape",
    [
        BoxShape(size=[0.3, 0.2, 1.0]),
        SphereShape(radius=0.4),
        CylinderShape(radius=0.06, length=0.3),
        CylinderShape(radius=2.0, length=0.01),
        CapsuleShape(radius=0.1, length=0.5),
        ConvexShape(points=CLOUD[:300]),
        ConvexShape(points=[[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]),
        PointsShape(points=CLOUD[:40], radius=0.05),
        PointsShape(points=CLOUD, radius=0.05),
    ],
    ids=lambda shape: f"{shape.type}",
)
def test_pieces_contain_the_points_of_their_shape(shape: Shape) -> None:
    points = surface(shape, np.random.default_rng(4))
    pieces, excess = enclose(shape)
    for point in points[:40]:
        gaps = [gap(piece, point) for piece in near(pieces, point)]
        assert min(gaps) <= COAL_TOLERANCE
    assert excess >= 0.0


def near(pieces: tuple[ConvexPiece, ...], point: Array) -> list[ConvexPiece]:
    """The pieces whose boxes contain a point."""
    slack = 1e-6
    return [
        x
        for x in pieces
        if np.all(x.points.min(axis=0) - x.radius - slack <= point)
        and np.all(point <= x.points.max(axis=0) + x.radius + slack)
    ]


def gap(piece: ConvexPiece, point: Array) -> float:
    """Distance of a point to a piece by coal [m]."""
    bodies = [Body("a", 0, (piece,)), Body("b", 0, (ConvexPiece(point[None], 0.0),))]
    nearest = Contacts(bodies, np.array([[0, 1]])).nearest(*STILL)
    assert nearest is not None
    return nearest.distance


def test_a_prism_reaches_beyond_its_cylinder_by_its_excess() -> None:
    for radius in (0.005, 0.06, 0.5, 3.0):
        pieces, excess = enclose(CylinderShape(radius=radius, length=1.0))
        reach = np.linalg.norm(pieces[0].points[:, :2], axis=1).max()
        assert reach == pytest.approx(radius + excess, rel=1e-12)
        assert excess <= max(1e-3, 0.005 * radius)
