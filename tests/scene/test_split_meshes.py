"""Meshes divided into parts: nothing is left out, and the hulls reach less beyond the mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import orjson
import pytest
from numpy.typing import NDArray

from catalogue.bodies.measure import Piece, measured_excess
from catalogue.bodies.split import Limits, cut_triangles, split_mesh
from ikplan.robots.definition.collision import CollisionFile
from ikplan.scene.hulls import distance_beyond, hull_of
from ikplan.scene.urdf_shapes import MeshGeometry

Array = NDArray[np.float64]
FILES = sorted((Path(__file__).parents[2] / "robots").glob("*/collision.json"))
CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)


def of_boxes(*boxes: tuple[tuple[float, ...], tuple[float, ...]]) -> MeshGeometry:
    """The surfaces of boxes, each from a low to a high corner [m], facing outwards."""
    triangles = []
    for low, high in boxes:
        points = np.array(low) + CORNERS * (np.array(high) - np.array(low))
        hull = hull_of(points)
        assert hull is not None
        for corners, plane in zip(points[hull.simplices], hull.equations, strict=True):
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            triangles.append(corners if normal @ plane[:3] > 0.0 else corners[::-1])
    vertices = np.array(triangles).reshape(-1, 3)
    return MeshGeometry("part", vertices, np.arange(len(vertices)).reshape(-1, 3))


ANGLE = of_boxes(((0, 0, 0), (0.2, 0.05, 0.05)), ((0, 0.05, 0), (0.05, 0.2, 0.05)))


def pieces(parts: list[Array]) -> list[Piece]:
    return [(part, 0.0) for part in parts]


def test_an_angle_is_two_parts_that_hold_it() -> None:
    parts = split_mesh(ANGLE, Limits(beyond=0.01, most=6))
    assert len(parts) == 2
    whole = measured_excess(pieces([ANGLE.vertices]), ANGLE)
    assert whole > 0.05
    assert measured_excess(pieces(parts), ANGLE) < 0.01
    places = cut_triangles(ANGLE.vertices[ANGLE.triangles], 0.02).mean(axis=1)
    hulls = [hull_of(part) for part in parts]
    beyond = np.min([distance_beyond(places, h) for h in hulls if h is not None], axis=0)
    assert beyond.max() <= 1e-12


def test_no_more_parts_are_made_than_asked_for_and_none_where_nothing_is_gained() -> None:
    assert len(split_mesh(ANGLE, Limits(beyond=1e-4, most=1))) == 1
    box = of_boxes(((0, 0, 0), (0.1, 0.2, 0.05)))
    assert len(split_mesh(box, Limits(beyond=1e-4, most=6))) == 1


def test_triangles_are_cut_without_a_gap() -> None:
    whole = ANGLE.vertices[ANGLE.triangles]
    small = cut_triangles(whole, 0.03)
    edges = np.linalg.norm(small - np.roll(small, 1, axis=1), axis=2)
    assert edges.max() <= 0.03

    def area(triangles: Array) -> float:
        sides = triangles[:, 1:] - triangles[:, :1]
        return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum())

    assert area(small) == pytest.approx(area(whole), rel=1e-12)


LARGER = {"baxter_left", "baxter_right", "so101", "kuka_kr6_r700_sixx", "kuka_kr6_r900_sixx"}
"""Robots of which some pieces reach more than 15 mm beyond their mesh, as their files say."""


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.parent.name)
def test_every_piece_of_the_catalogue_has_a_licence_and_a_measured_excess(file: Path) -> None:
    shapes = CollisionFile.model_validate(orjson.loads(file.read_bytes()))
    assert shapes.licence
    for link, shape in shapes.links.items():
        assert shape.excess is not None, link
        assert shape.excess <= 0.015 or file.parent.name in LARGER, link
