"""Spheres and boxes about pieces: they hold what they are about, and never bound too far."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from ikplan import load_robot
from ikplan.collision.checker import CollisionChecker
from ikplan.collision.coverings import covering_spheres, enclosing_box
from ikplan.collision.pair_gaps import bounded_gap, place_pieces, sphere_gap
from ikplan.scene.body import Body, CollisionModel, ConvexPiece
from tests.collision.models import coal_gaps, random_model

Array = NDArray[np.float64]


def inside_hull(rng: np.random.Generator, points: Array, count: int) -> Array:
    shares = rng.dirichlet(np.full(len(points), 0.3), count)
    return np.asarray(np.vstack([shares @ points, points]))


@pytest.mark.parametrize("seed", range(20))
def test_the_spheres_cover_the_hull_and_the_box_holds_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scale = np.exp(rng.uniform(-4.0, 1.0, 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    points = (rng.normal(size=(int(rng.integers(1, 60)), 3)) * scale) @ turn + rng.normal(size=3)
    within = inside_hull(rng, points, 400)
    spheres = covering_spheres(points)
    apart = np.linalg.norm(within[:, None] - spheres[None, :, :3], axis=2) - spheres[:, 3]
    assert apart.min(axis=1).max() <= 0.0
    axes, centre, half = enclosing_box(points)
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert (np.abs((within - centre) @ axes.T) <= half).all()


def test_the_box_about_a_turned_box_is_that_box() -> None:
    rng = np.random.default_rng(1)
    half = np.array([0.6, 0.17, 0.02])
    corners = half * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    _, centre, found = enclosing_box(corners @ turn.T + 0.3)
    assert np.allclose(np.sort(found), np.sort(half), atol=1e-7)
    assert np.allclose(centre, 0.3, atol=1e-9)


@pytest.mark.parametrize("name", ["ur5", "panda", "kinova_j2s6s200"])
def test_no_cheap_bound_is_above_the_gap_that_coal_finds(name: str) -> None:
    robot, rng = load_robot(name), np.random.default_rng(3)
    useful = 0
    for _ in range(4):
        model = random_model(robot, rng)
        arrays = CollisionChecker(robot, model).arrays(None)
        for _ in range(6):
            q = robot.random_configuration(rng)
            reference = coal_gaps(robot, model, q)
            place_pieces(arrays.chain, arrays.bodies, np.ascontiguousarray(q), arrays.scratch)
            bound = np.full(len(reference), np.inf)
            for row, (i, j) in enumerate(arrays.bodies.pairs):
                spheres = sphere_gap(arrays.bodies, i, j, arrays.scratch)
                found = bounded_gap(arrays.bodies, i, j, np.inf, arrays.scratch)
                at = arrays.bodies.pair_of[row]
                bound[at] = min(bound[at], max(spheres, found))
            assert (bound <= np.maximum(reference, 0.0) + 2e-6).all()
            useful += int((bound > 0.0).sum())
    assert useful > 50


def test_a_curve_of_cubics_is_proven_only_where_dense_places_on_it_are_free() -> None:
    robot, rng = load_robot("ur5"), np.random.default_rng(8)
    proven = refused = 0
    for _ in range(20):
        model = random_model(robot, rng, obstacles=3)
        checker = CollisionChecker(robot, model)
        q = np.vstack([robot.random_configuration(rng)] * 2)
        q[1] += 0.3 * rng.normal(size=robot.dof)
        m0, m1 = 0.6 * rng.normal(size=(2, 1, robot.dof))
        found = checker.contacts_on_curve(np.array([0.0, 1.0]), q, (m0, m1), None, 0.0)
        x = np.linspace(0.0, 1.0, 500)[:, None]
        dense = (
            q[0] * (1 + 2 * x) * (1 - x) ** 2 + q[1] * x * x * (3 - 2 * x)
            + m0 * x * (1 - x) ** 2 - m1 * x * x * (1 - x)
        )  # fmt: skip
        free = checker.free(dense)
        if found[0]:
            refused += 1
        else:
            proven += 1
            assert free.all()
        if not free.all():
            assert found[0]
    assert proven > 2
    assert refused > 2


def test_a_straight_line_as_a_cubic_has_the_same_verdict() -> None:
    robot, rng = load_robot("panda"), np.random.default_rng(9)
    verdicts = set()
    for _ in range(20):
        checker = CollisionChecker(robot, random_model(robot, rng, obstacles=4))
        q = np.vstack([robot.random_configuration(rng)] * 2)
        q[1] = robot.clip(q[1] + 0.3 * rng.normal(size=robot.dof))
        m = (q[1] - q[0])[None]
        straight = checker.first_contact(q) is not None
        curved = checker.contacts_on_curve(np.array([0.0, 1.0]), q, (m, m), None, 0.0)[0]
        assert straight == curved
        verdicts.add(straight)
    assert verdicts == {True, False}


def test_a_sphere_and_a_box_have_the_distance_of_the_closed_form() -> None:
    robot = load_robot("ur5")
    tip = robot.model.njoints - 1
    T = robot.fk(robot.home)
    corners = 0.1 * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    place = T.translation + np.array([0.0, 0.0, -0.4])
    model = CollisionModel(
        (
            Body("ball", tip, (ConvexPiece(np.zeros((1, 3)), 0.02),)),
            Body("box", 0, (ConvexPiece(corners + place, 0.0),)),
        ),
        np.array([[0, 1]]),
        0.0,
    )
    arrays = CollisionChecker(robot, model).arrays(None)
    place_pieces(arrays.chain, arrays.bodies, robot.home.copy(), arrays.scratch)
    (i, j) = arrays.bodies.pairs[0]
    bound = bounded_gap(arrays.bodies, i, j, np.inf, arrays.scratch)
    centre = arrays.scratch.centre[j]
    beyond = np.maximum(np.abs(centre - place) - 0.1, 0.0)
    assert bound == pytest.approx(float(np.linalg.norm(beyond)) - 0.02, abs=1e-7)
    assert bound == pytest.approx(CollisionChecker(robot, model).least_gap(robot.home)[0], abs=1e-7)


def slices(points: Array, count: int) -> list[Array]:
    """The corners of equal slices of a hull across its longest side."""
    axes, _, half = enclosing_box(points)
    along = points @ axes[np.argsort(-half, kind="stable")[0]]
    cuts = np.linspace(along.min(), along.max(), count + 1)
    found = []
    for low, high in zip([-np.inf, *cuts[1:-1]], [*cuts[1:-1], np.inf], strict=True):
        corners = [points[(along >= low) & (along <= high)]]
        for cut in (low, high):
            for a, b in np.argwhere((along[:, None] < cut) & (along[None] > cut)):
                share = (cut - along[a]) / (along[b] - along[a])
                if np.isfinite(cut):
                    corners.append((points[a] + share * (points[b] - points[a]))[None])
        found.append(np.concatenate(corners))
    return found


def plain_sphere(points: Array) -> Array:
    """The sphere of M. Badoiu and K. L. Clarkson about points, all compared at every step."""
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    best, radius = centre, np.inf
    for step in range(1, 60):
        distance = np.linalg.norm(points - centre, axis=1)
        if distance.max() < radius:
            best, radius = centre, float(distance.max())
        centre = centre + (points[np.argmax(distance)] - centre) / (step + 1)
    return np.append(best, radius)


@pytest.mark.parametrize("count", [8, 20, 60, 90])
def test_the_spheres_are_those_of_comparing_all_corners_at_every_step(count: int) -> None:
    rng = np.random.default_rng(count)
    angle = np.linspace(0.0, 2.0 * np.pi, count // 2, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count // 2)])
    prism = np.vstack([ring, ring + np.array([0.0, 0.0, 3.0])])  # many corners equally far
    for points in (rng.normal(size=(count, 3)) + 5.0, prism):
        found = covering_spheres(points)
        expected = np.array([plain_sphere(corners) for corners in slices(points, len(found))])
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-9)
