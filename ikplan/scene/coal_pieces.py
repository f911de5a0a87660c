"""Convex pieces as shapes of coal, for distances at single configurations."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any, NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from ikplan.scene.body import Body, ConvexPiece
from ikplan.scene.hulls import hull_of, span_a_volume

__all__ = ["CoalPiece", "coal_piece", "coal_pieces_of"]

Array = NDArray[np.float64]

_THIN = 1e-6
"""Half the thickness that a flat piece is given, since coal wants a volume [m]."""
_FEW = 32
"""So many points do without their hull, which is slow to import."""
_POINT = 1e-9
"""Radius that a point or a line is given [m]."""


class CoalPiece(NamedTuple):
    """A shape of coal, its pose in the frame of the piece, and a ball around it.

    Attributes:
        shape: The shape.
        pose: Its pose (coal.Transform3s).
        centre: Centre of the ball, shape (3,) [m].
        radius: Radius of the ball [m].
    """

    shape: Any
    pose: Any
    centre: Array
    radius: float


@functools.lru_cache(maxsize=1024)
def coal_pieces_of(body: Body) -> tuple[CoalPiece, ...]:
    """Return the pieces of a body as shapes of coal; those of a link are made once."""
    return tuple(coal_piece(piece) for piece in body.pieces)


def coal_piece(piece: ConvexPiece) -> CoalPiece:
    """Return a piece as a shape of coal; a flat one is thicker by 1e-6 m on each side."""
    points = np.ascontiguousarray(piece.points, dtype=np.float64)
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    around = float(np.linalg.norm(points - centre, axis=1).max()) + piece.radius
    pose = coal.Transform3s()
    if len(points) == 1:
        pose.setTranslation(points[0])
        return CoalPiece(coal.Sphere(max(piece.radius, _POINT)), pose, centre, around)
    if len(points) == 2:
        line = points[1] - points[0]
        pose = coal.Transform3s(_turned(line), points.mean(axis=0))
        length = float(np.linalg.norm(line))
        return CoalPiece(coal.Capsule(max(piece.radius, _POINT), length), pose, centre, around)
    if len(points) <= _FEW and span_a_volume(points):
        shape = _convex(points, _every_pair(len(points)))
        shape.setSweptSphereRadius(piece.radius)
        return CoalPiece(shape, pose, centre, around)
    hull = hull_of(points)
    if hull is None:
        _, _, axes = np.linalg.svd(points - points.mean(axis=0))
        shifts = [s * _THIN * axis for axis in axes for s in (-1.0, 1.0)]
        from scipy.spatial import ConvexHull  # slow to import

        hull = ConvexHull(np.concatenate([points + shift for shift in shifts]))
        around += _THIN
    number = np.zeros(len(hull.points), dtype=np.int64)
    number[hull.vertices] = np.arange(len(hull.vertices))
    shape = _convex(hull.points[hull.vertices], number[hull.simplices].tolist())
    shape.setSweptSphereRadius(piece.radius)
    return CoalPiece(shape, pose, centre, around)


def _convex(points: Array, faces: Sequence[Sequence[int]]) -> Any:
    """Return a shape of coal.

    Given as a hull already: coal's own hulls of points end the process now and then.
    """
    vertices, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in points:
        vertices.append(point)
    for face in faces:
        triangles.append(coal.Triangle(*face))
    return coal.Convex(vertices, triangles)


def _every_pair(count: int) -> list[list[int]]:
    """Return triangles with an edge between every two of some points.

    coal goes along edges to the farthest point, and takes nothing else from the triangles; with
    an edge between every two points it is at the farthest in one step, whatever their hull.
    """
    pairs = [(i, j) for i in range(count) for j in range(i + 1, count)]
    return [[i, j, next(k for k in range(count) if k not in (i, j))] for i, j in pairs]


def _turned(direction: Array) -> Array:
    """A rotation that takes z to a direction."""
    length = float(np.linalg.norm(direction))
    z = direction / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
