"""The collision geometry of a URDF, as convex pieces in the frames of its links."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlparse

import numpy as np
from numpy.typing import NDArray

from ikplan.documents.shape import BoxShape, CylinderShape, Shape, SphereShape
from ikplan.errors import InvalidRequest, InvalidRobot
from ikplan.robots.urdf.meshes import find_mesh
from ikplan.robots.urdf.safe_xml import read_xml
from ikplan.scene.body import ConvexPiece
from ikplan.scene.hulls import enclosing_points
from ikplan.scene.links import rotation_rpy
from ikplan.scene.meshes import read_mesh, read_vertices
from ikplan.scene.shapes import enclose, transformed

__all__ = ["LinkPieces", "MeshGeometry", "link_meshes", "urdf_shapes"]

Array = NDArray[np.float64]

MAX_SHAPES = 1_000
"""Most shapes of one robot."""
MAX_TOTAL_VERTICES = 5_000_000
"""Most vertices of all meshes of one robot."""
_HULL_POINTS = 128
_HULL_TOLERANCE = 5e-4
"""A hull is thinned to so many points, or to fewer that are as near as this [m]."""
_NUMBERS = {"box": ("size", 3), "sphere": ("radius", 1), "cylinder": ("radius", 1)}


class LinkPieces(NamedTuple):
    """The pieces of a link, in its frame.

    Attributes:
        pieces: The pieces.
        source: What they enclose, in words.
        excess: How far they reach beyond primitives, or beyond the hulls of meshes [m].
        missing: What could not be read, in words; empty: nothing.
    """

    pieces: tuple[ConvexPiece, ...]
    source: str
    excess: float
    missing: tuple[str, ...]


class MeshGeometry(NamedTuple):
    """A mesh of a link, in the frame of the link."""

    link: str
    vertices: Array
    triangles: NDArray[np.int64]


def urdf_shapes(
    document: bytes, folder: str | None, robot: str, skip: frozenset[str] = frozenset()
) -> dict[str, LinkPieces]:
    """Read the collision geometry of a URDF.

    Args:
        document: The URDF.
        folder: Folder of that file, for meshes beside it; None: only those of packages.
        robot: Name of the robot, for messages.
        skip: Links that are not wanted; none of their meshes is opened.

    Returns:
        What each link with collision geometry is made of, by name.

    Raises:
        InvalidRobot: A primitive makes no sense, or there are too many shapes.
    """
    found: dict[str, LinkPieces] = {}
    count, vertices = 0, 0
    for link in read_xml(document, robot=robot).findall("link"):
        name = link.get("name", "")
        if name in skip:
            continue
        pieces: list[ConvexPiece] = []
        missing: list[str] = []
        excess, sources = 0.0, set[str]()
        for element in link.findall("collision"):
            count += 1
            if count > MAX_SHAPES:
                raise InvalidRobot(f"{robot}: more than {MAX_SHAPES} shapes", robot=robot)
            shape = _geometry(element)
            R, p = _origin(element, robot, name)
            if shape is None or shape.tag == "mesh":
                try:
                    corners = read_vertices(*_mesh(shape, folder))
                except (InvalidRequest, InvalidRobot) as error:
                    missing.append(error.detail)
                    continue
                vertices += len(corners)
                if vertices > MAX_TOTAL_VERTICES:
                    missing.append(f"more than {MAX_TOTAL_VERTICES:,} vertices in all")
                    continue
                points, radius, extra = enclosing_points(corners, _HULL_POINTS, _HULL_TOLERANCE)
                made: tuple[ConvexPiece, ...] = (ConvexPiece(points, radius),)
                sources.add("convex hull of the URDF's mesh")
            else:
                made, extra = enclose(_primitive(shape, robot, name))
                sources.add(f"the URDF's {shape.tag}")
            pieces += transformed(made, R, p)
            excess = max(excess, extra)
        if pieces or missing:
            source = " and ".join(sorted(sources))
            found[name] = LinkPieces(tuple(pieces), source, excess, tuple(missing))
    return found


def link_meshes(document: bytes, folder: str | None, robot: str) -> list[MeshGeometry]:
    """Read the meshes of a URDF's collision geometry, in the frames of their links.

    Raises:
        InvalidRequest: A mesh cannot be read.
        InvalidRobot: A mesh is not found.
    """
    meshes = []
    for link in read_xml(document, robot=robot).findall("link"):
        for element in link.findall("collision"):
            shape = _geometry(element)
            if shape is not None and shape.tag == "mesh":
                R, p = _origin(element, robot, link.get("name", ""))
                vertices, triangles = read_mesh(*_mesh(shape, folder))
                meshes.append(MeshGeometry(link.get("name", ""), vertices @ R.T + p, triangles))
    return meshes


def _geometry(element: ET.Element) -> ET.Element | None:
    geometry = element.find("geometry")
    return None if geometry is None else next(iter(geometry), None)


def _origin(element: ET.Element, robot: str, link: str) -> tuple[Array, Array]:
    origin = element.find("origin")
    if origin is None:
        return np.eye(3), np.zeros(3)
    xyz = _floats(origin.get("xyz", "0 0 0"), 3, robot, link)
    r, p, y = _floats(origin.get("rpy", "0 0 0"), 3, robot, link)
    return rotation_rpy((r, p, y)), np.array(xyz)


def _primitive(shape: ET.Element, robot: str, link: str) -> Shape:
    if shape.tag not in _NUMBERS:
        raise InvalidRobot(
            f"{robot}: link {link!r} has a shape {shape.tag[:40]!r}; URDF knows "
            f"{', '.join(_NUMBERS)} and mesh",
            robot=robot,
            value=shape.tag[:40],
        )
    key, count = _NUMBERS[shape.tag]
    sizes = _floats(shape.get(key, ""), count, robot, link, positive=True)
    if shape.tag == "box":
        return BoxShape(size=sizes)
    if shape.tag == "sphere":
        return SphereShape(radius=sizes[0])
    (length,) = _floats(shape.get("length", ""), 1, robot, link, positive=True)
    return CylinderShape(radius=sizes[0], length=length)


def _floats(text: str, count: int, robot: str, link: str, *, positive: bool = False) -> list[float]:
    try:
        values = [float(part) for part in text.split()]
    except ValueError:
        values = []
    low = 0.0 if positive else -np.inf
    if len(values) != count or not all(abs(v) <= 1e3 and v > low for v in values):
        what = f"{count} positive numbers" if positive else f"{count} numbers"
        raise InvalidRobot(
            f"{robot}: the collision geometry of link {link!r} has {text[:200]!r} where {what} "
            "of at most 1000 are required",
            robot=robot,
            value=text[:200],
        )
    return values


def _mesh(shape: ET.Element | None, folder: str | None) -> tuple[Path, tuple[float, float, float]]:
    """The file of a mesh and the factors on its coordinates."""
    if shape is None:
        raise InvalidRobot("a collision without geometry")
    uri = shape.get("filename", "")
    x, y, z = _floats(shape.get("scale", "1 1 1"), 3, "mesh", uri)
    return _mesh_file(uri, folder), (x, y, z)


def _mesh_file(uri: str, folder: str | None) -> Path:
    """The file of a mesh: of the installed package of robots, or near the URDF."""
    try:
        return find_mesh(uri)[1]
    except InvalidRobot:
        if folder is None:
            raise
    for candidate in _candidates(uri, Path(folder)):
        if candidate.is_file():
            return candidate
    raise InvalidRobot(f"the mesh {uri[:200]!r} is not found", value=uri[:200])


def _candidates(uri: str, folder: Path) -> list[Path]:
    if uri.startswith("file://"):
        return [Path(unquote(urlparse(uri).path))]
    if not uri.startswith("package://"):
        return [folder / uri]
    package, _, rest = uri.removeprefix("package://").partition("/")
    above = [folder, *folder.parents]
    places = [place for place in above if place.name == package]
    places += [place / package for place in above]
    paths = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    places += [Path(part) / package for part in paths if part]
    return [place / rest for place in places]
