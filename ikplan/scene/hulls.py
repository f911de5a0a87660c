"""Convex hulls of points, and hulls of fewer points that enclose them.

A hull is thinned by leaving out points and enlarging what is left by a radius, so that every
point that was left out is still inside.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull

__all__ = ["distance_beyond", "enclosing_points", "hull_of", "span_a_volume"]

Array = NDArray[np.float64]

_FLAT = 1e-9
"""A set of points thinner than this share of its size [1] has no volume to speak of."""
_ROUNDING = 1e-12
"""Added to a radius, so that rounding leaves no point outside [m]."""
_CHUNK = 4_000_000
_NEAREST_FACES = 12
"""Faces that are looked at for the distance of a point."""
_LOOKED_AT = 2_000
"""Most vertices among which those that stay are chosen; the radius is about all of them."""
_AT_ONCE = 8
"""Most points that are added before their hull is made anew."""


def span_a_volume(points: Array) -> bool:
    """Whether points lie neither in a plane, nor on a line, nor together."""
    if len(points) < 4:
        return False
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[2] > _FLAT * spread[0])


def hull_of(points: Array) -> ConvexHull | None:
    """Return the convex hull, or None where the points lie in a plane, on a line or together."""
    if not span_a_volume(points):
        return None
    from scipy.spatial import ConvexHull, QhullError  # slow to import

    try:
        return ConvexHull(points)
    except QhullError:
        return None


def distance_beyond(points: Array, hull: ConvexHull) -> Array:
    """How far points are outside a hull, from above.

    Args:
        points: Shape (n, 3) [m].
        hull: The hull.

    Returns:
        Shape (n,): 0 inside, else the distance to the nearest of the faces whose planes are the
        farthest below the point [m]: never less than the distance.
    """
    planes, face = np.unique(hull.equations, axis=0, return_inverse=True)
    triangles = hull.points[hull.simplices]
    count = min(len(planes), _NEAREST_FACES)
    found = np.zeros(len(points))
    for first, above in _heights(points, planes):
        outside = np.flatnonzero(above.max(axis=1) > 0.0)
        if not len(outside):
            continue
        nearest = np.argpartition(-above[outside], count - 1, axis=1)[:, :count]
        place, gaps = points[first + outside], np.full(len(outside), np.inf)
        for k, triangle in enumerate(triangles):
            rows = np.flatnonzero((nearest == face[k]).any(axis=1))
            if len(rows):
                gaps[rows] = np.minimum(gaps[rows], _to_triangle(place[rows], triangle))
        found[first + outside] = gaps
    return found


def _heights(points: Array, planes: Array) -> Iterator[tuple[int, Array]]:
    """Heights of points above planes, some points at a time [m]."""
    normals, offsets = planes[:, :3], planes[:, 3]
    step = max(1, _CHUNK // len(offsets))
    for first in range(0, len(points), step):
        yield first, points[first : first + step] @ normals.T + offsets


def enclosing_points(
    points: Array, most: int = 64, tolerance: float = 0.0
) -> tuple[Array, float, float]:
    """Return few points and a radius that enclose the convex hull of points.

    Args:
        points: Shape (n, 3), n >= 1 [m].
        most: Most points returned, where the points span a volume.
        tolerance: Radius at which no more points are taken [m].

    Returns:
        The points, shape (m, 3), the radius about their hull [m], and how far that reaches
        beyond the hull of all points [m].
    """
    points = np.unique(np.asarray(points, dtype=np.float64), axis=0)
    hull = hull_of(points)
    if hull is None:
        return _enclosing_flat(points, most)
    vertices = points[np.sort(hull.vertices)]
    if len(vertices) <= most:
        return vertices, 0.0, 0.0
    looked_at = vertices if len(vertices) <= _LOOKED_AT else vertices[_outermost(vertices)]
    kept = _chosen(looked_at, most, tolerance)
    inner = hull_of(kept)
    if inner is None:
        return vertices, 0.0, 0.0
    radius = float(distance_beyond(vertices, inner).max()) + _ROUNDING
    return kept, radius, radius


def _chosen(vertices: Array, most: int, tolerance: float) -> Array:
    """Vertices whose hull comes near to that of all: each time those farthest outside it."""
    chosen = _extremes(vertices)
    while True:
        inner = hull_of(vertices[chosen])
        if inner is None:  # the extremes of a thin body may lie in a plane
            chosen = np.unique([*chosen, *range(0, len(vertices), max(1, len(vertices) // 16))])
            inner = hull_of(vertices[chosen])
            if inner is None:
                return vertices
        above = [part.max(axis=1) for _, part in _heights(vertices, inner.equations)]
        beyond = np.maximum(np.concatenate(above), 0.0)
        beyond[chosen] = 0.0
        radius = float(beyond.max())
        if len(chosen) >= most or radius <= tolerance:
            return vertices[chosen]
        order = np.argsort(-beyond, kind="stable")[: min(_AT_ONCE, most - len(chosen))]
        more = _apart(vertices, order[beyond[order] > 0.0], radius)
        chosen = np.unique([*chosen, *more])


def _apart(vertices: Array, order: NDArray[np.int64], radius: float) -> list[int]:
    """Points of a list that are not close to an earlier one of it."""
    taken: list[int] = []
    for index in order:
        gaps = np.linalg.norm(vertices[taken] - vertices[index], axis=1)
        if not len(gaps) or gaps.min() > 4.0 * radius:
            taken.append(int(index))
    return taken


def _outermost(vertices: Array) -> NDArray[np.int64]:
    """The farthest vertices along directions spread evenly (Fibonacci's lattice)."""
    k = np.arange(_LOOKED_AT) + 0.5
    z = 1.0 - 2.0 * k / _LOOKED_AT
    turn = math.pi * (3.0 - math.sqrt(5.0)) * k
    width = np.sqrt(1.0 - z * z)
    directions = np.column_stack([width * np.cos(turn), width * np.sin(turn), z])
    step = max(1, _CHUNK // len(vertices))
    parts = [directions[i : i + step] for i in range(0, _LOOKED_AT, step)]
    return np.unique(np.concatenate([(vertices @ part.T).argmax(axis=0) for part in parts]))


def _extremes(vertices: Array) -> NDArray[np.int64]:
    """The points farthest along the axes and the diagonals between them."""
    grid = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    directions = grid[np.any(grid != 0, axis=1)]
    return np.unique((vertices @ directions.T).argmax(axis=0))


def _enclosing_flat(points: Array, most: int) -> tuple[Array, float, float]:
    """As :func:`enclosing_points`, of points in a plane, on a line or together."""
    centre = points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points - centre, full_matrices=False)
    if len(points) <= 3 or len(spread) < 3:
        return points, 0.0, 0.0
    flat = (points - centre) @ axes.T
    if spread[1] > _FLAT * spread[0]:
        from scipy.spatial import ConvexHull, QhullError

        try:
            kept = np.sort(ConvexHull(flat[:, :2]).vertices)
        except QhullError:
            kept = np.arange(len(points), dtype=np.int32)
    else:
        kept = np.array([flat[:, 0].argmin(), flat[:, 0].argmax()], dtype=np.int32)
    if len(kept) <= most:
        rest = flat[:, 2] if spread[1] > _FLAT * spread[0] else np.hypot(flat[:, 1], flat[:, 2])
        # Out of the plane, or off the line, by rounding at most.
        radius = 2.0 * float(np.abs(rest).max()) + _ROUNDING
        return points[kept], radius, radius
    low, high = flat.min(axis=0), flat.max(axis=0)
    corners = np.array([(x, y, 0.0) for x in (low[0], high[0]) for y in (low[1], high[1])])
    radius = 2.0 * float(np.abs(flat[:, 2]).max()) + _ROUNDING
    return centre + corners @ axes, radius, float(np.linalg.norm(high - low))


def _to_triangle(points: Array, triangle: Array) -> Array:
    """Distance of points, shape (n, 3), to a triangle, shape (3, 3)."""
    best = np.full(len(points), np.inf)
    for i in range(3):
        a = triangle[i]
        edge = triangle[(i + 1) % 3] - a
        share = np.clip((points - a) @ edge / max(float(edge @ edge), 1e-300), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - a - share[:, None] * edge, axis=1))
    u, v = triangle[1] - triangle[0], triangle[2] - triangle[0]
    normal = np.cross(u, v)
    square = float(normal @ normal)
    if square == 0.0:
        return best
    w = points - triangle[0]
    beta, gamma = np.cross(w, v) @ normal / square, np.cross(u, w) @ normal / square
    height = np.abs(w @ normal) / math.sqrt(square)
    above = (beta >= 0.0) & (gamma >= 0.0) & (beta + gamma <= 1.0)
    return np.where(above, np.minimum(height, best), best)
