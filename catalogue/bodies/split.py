"""Divide meshes into parts whose convex hulls reach little beyond them.

Between a mesh and its hull there is space that the hull fills for nothing: points of a grid that
are outside the mesh and inside the hull, each with its distance from the mesh. The part whose hull
reaches farthest is divided at the plane that leaves the least of that space in the hulls of both
halves, over and over. Every triangle lies in one part, and so in its hull.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ikplan.scene.hulls import hull_of
from ikplan.scene.urdf_shapes import MeshGeometry

__all__ = ["Limits", "Search", "cut_triangles", "split_mesh"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

EDGE = 0.005
"""Longest edge of the triangles that are given to parts [m]."""
_NEAR = 0.003
"""Space nearer to the mesh than this is not counted [m]."""
_FINEST = 0.003
"""Least distance of the points of a grid [m]."""
_LEAST_GAIN = 0.02
"""Share of the space of a part that its division takes away at least."""
_CELL = 0.006
"""Edge of the cells in which triangles are summed up for winding numbers [m]."""
_CHUNK = 4_000_000


class Search(NamedTuple):
    """Where planes are looked for that divide a part.

    Attributes:
        grid: About the most points of the grid.
        planes: Places across each direction.
        corners: About the distance of the corners that are looked at [m].
        diagonals: Whether the diagonals of three axes are among the directions.
    """

    grid: int = 30_000
    planes: int = 12
    corners: float = 0.006
    diagonals: bool = False


class Limits(NamedTuple):
    """How far meshes are split.

    Attributes:
        beyond: Reach beyond the mesh at which a part is divided [m].
        most: Most parts of a mesh; 1: none is divided.
        points: Most points of a hull; of a part, five sixths of it.
        tolerance: Reach of fewer points beyond a hull that is small enough to take them [m].
        search: Where planes are looked for that divide a part.
    """

    beyond: float = 0.013
    most: int = 6
    points: int = 192
    tolerance: float = 1e-4
    search: Search = Search()


class _Part(NamedTuple):
    """Triangles, shape (n, 3, 3), and which points of the grid their hull holds for nothing."""

    triangles: Array
    inside: NDArray[np.int64]


def split_mesh(mesh: MeshGeometry, limits: Limits) -> list[Array]:
    """Return the points of parts of a mesh, each shape (n, 3) [m].

    Args:
        mesh: The mesh.
        limits: How far it is split.
    """
    triangles = cut_triangles(mesh.vertices[mesh.triangles], EDGE)
    points, depth = _space(mesh.vertices, triangles, limits.search.grid)
    parts = [_part(triangles, points, np.arange(len(points)))]
    final: list[_Part] = []
    while parts and len(parts) + len(final) < limits.most:
        k = max(range(len(parts)), key=lambda k: depth[parts[k].inside].max(initial=0.0))
        part = parts.pop(k)
        if depth[part.inside].max(initial=0.0) <= limits.beyond:
            final.append(part)
            break
        halves = _divided(part, points, depth, limits.search)
        if halves:
            parts += halves
        else:
            final.append(part)
    return [part.triangles.reshape(-1, 3) for part in (*parts, *final)]


def cut_triangles(triangles: Array, edge: float) -> Array:
    """Halve triangles, shape (n, 3, 3) [m], at their longest edges until none is longer."""
    done = []
    while len(triangles):
        edges = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
        long = edges.max(axis=1) > edge
        done.append(triangles[~long])
        turn = edges[long].argmax(axis=1)
        rows = np.arange(len(turn))
        a, b, c = (triangles[long][rows, (turn + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        triangles = np.concatenate(halves)
    return np.concatenate(done)


def _space(vertices: Array, triangles: Array, most: int) -> tuple[Array, Array]:
    """Points of a grid within the hull of a mesh and outside the mesh, and their distances [m]."""
    hull = hull_of(vertices)
    if hull is None:
        return np.empty((0, 3)), np.empty(0)
    pitch = max(_FINEST, (hull.volume / most) ** (1.0 / 3.0))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    axes = [np.arange(low[k] + 0.5 * pitch, high[k], pitch) for k in range(3)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    # Corners of the hull's facets reach farther than the grid does.
    grid = np.concatenate([grid, hull.points[hull.simplices].mean(axis=1)])
    grid = grid[_within(grid, hull.equations)]
    samples = np.concatenate([triangles.reshape(-1, 3), triangles.mean(axis=1)])
    distance, _ = cKDTree(samples).query(grid)
    far = distance > _NEAR
    grid, distance = grid[far], distance[far]
    outside = ~_wound(grid, triangles)
    return grid[outside], distance[outside]


def _within(points: Array, planes: Array) -> Flags:
    """Which points are below all planes, shape (n,)."""
    found = np.ones(len(points), dtype=np.bool_)
    step = max(1, _CHUNK // max(len(points), 1))
    for first in range(0, len(planes), step):
        rows = planes[first : first + step]
        left = np.flatnonzero(found)
        found[left] = (points[left] @ rows[:, :3].T + rows[:, 3] <= 1e-9).all(axis=1)
    return found


def _wound(points: Array, triangles: Array) -> Flags:
    """Whether a surface winds around points that are not near to it, shape (n,).

    Triangles of one cell count as one dipole (G. Barill et al., "Fast Winding Numbers for Soups
    and Clouds", 2018).
    """
    middle = triangles.mean(axis=1)
    area = 0.5 * np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    _, cell = np.unique(np.floor(middle / _CELL).astype(np.int64), axis=0, return_inverse=True)
    cell = cell.ravel()
    size = np.linalg.norm(area, axis=1)
    total = np.maximum(np.bincount(cell, size), 1e-300)
    at = np.stack([np.bincount(cell, size * middle[:, k]) / total for k in range(3)], axis=1)
    dipole = np.stack([np.bincount(cell, area[:, k]) for k in range(3)], axis=1)
    found = np.zeros(len(points))
    for first in range(0, len(points), max(1, _CHUNK // len(at))):
        some = points[first : first + max(1, _CHUNK // len(at))]
        square = np.maximum(
            (some**2).sum(axis=1)[:, None] + (at**2).sum(axis=1)[None] - 2.0 * some @ at.T, 1e-12
        )
        along = (at * dipole).sum(axis=1)[None] - some @ dipole.T
        found[first : first + len(some)] = (along / (square * np.sqrt(square))).sum(axis=1)
    return np.asarray(np.abs(found) > 2.0 * np.pi)


def _part(triangles: Array, points: Array, among: NDArray[np.int64]) -> _Part:
    return _Part(triangles, among[_held(triangles.reshape(-1, 3), points[among])])


def _held(corners: Array, points: Array) -> Flags:
    """Which points the hull of corners holds, shape (n,)."""
    hull = hull_of(corners)
    if hull is None or not len(points):
        return np.zeros(len(points), dtype=np.bool_)
    planes = np.unique(hull.equations.round(9), axis=0)
    return _within(points, planes)


def _directions(search: Search) -> Array:
    grid = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    half = grid[14:]  # one of each pair of opposite directions
    if not search.diagonals:
        half = half[np.abs(half).sum(axis=1) < 3]
    return half / np.linalg.norm(half, axis=1)[:, None]


def _divided(part: _Part, points: Array, depth: Array, search: Search) -> list[_Part]:
    """Both halves of a part at the plane that leaves the least space; none: no plane pays."""
    middle = part.triangles.mean(axis=1)
    corners = part.triangles.reshape(-1, 3)
    owner = np.repeat(np.arange(len(middle)), 3)
    _, some = np.unique(
        np.round(corners / search.corners).astype(np.int64), axis=0, return_index=True
    )
    corners, owner = corners[some], owner[some]
    space, cost = points[part.inside], depth[part.inside] ** 2
    best, plane = (1.0 - _LEAST_GAIN) * cost.sum(), None
    for direction in _directions(search):
        along = middle @ direction
        for place in np.linspace(along.min(), along.max(), search.planes + 1)[1:-1]:
            below = along < place
            total = sum(cost[_held(corners[side[owner]], space)].sum() for side in (below, ~below))
            if total < best:
                best, plane = total, (direction, place)
    if plane is None:
        return []
    below = middle @ plane[0] < plane[1]
    return [_part(part.triangles[side], points, part.inside) for side in (below, ~below)]
