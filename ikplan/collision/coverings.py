"""Spheres that cover a convex piece, and a box about it: cheap bounds before hulls are compared.

The spheres of one piece against the box of the other bound their gap from below by some
multiplications a sphere; a box among the obstacles is its own.
"""

from __future__ import annotations

import functools
import math

import numpy as np

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, lengths_of

__all__ = ["covering_spheres", "enclosing_box", "sphere_box_gap"]

_MOST_SPHERES = 8
_STEPS = 60
"""Steps towards the smallest sphere about points."""
_FEW = 500
"""Of so many points the farthest is found at once."""
_ALIKE = 1e-12
"""Squares of distances that differ less, as a share of the greatest, are compared exactly."""
_ROUNDING = 1e-9
"""Added to what encloses, so that rounding leaves no point outside [m]."""


@functools.lru_cache(maxsize=1024)
def _box_of(content: bytes) -> tuple[Array, Array, Array]:
    points = np.frombuffer(content).reshape(-1, 3)
    best: tuple[float, Array, Array, Array] | None = None
    _, _, principal = np.linalg.svd(points - points.mean(axis=0), full_matrices=True)
    for axes in (np.eye(3), principal, *_edge_frames(points)):
        along = points @ axes.T
        low, high = along.min(axis=0), along.max(axis=0)
        half = 0.5 * (high - low) + _ROUNDING
        size = float(np.prod(half + 1e-6))
        if best is None or size < best[0] * (1.0 - 1e-9):
            best = size, axes, axes.T @ (0.5 * (low + high)), half
    assert best is not None
    return best[1:]


def _edge_frames(points: Array) -> list[Array]:
    """Frames along the edges at a corner of eight points: those of a box, if they are one."""
    if len(points) != 8:
        return []
    edges = points[1:] - points[0]
    edges = edges[np.argsort(lengths_of(edges), kind="stable")]
    first = edges[0] / max(float(np.linalg.norm(edges[0])), 1e-300)
    across = edges - np.outer(edges @ first, first)
    found = []
    for second in across[1:4]:
        length = float(np.linalg.norm(second))
        if length > 1e-9:
            v = second / length
            found.append(np.vstack([first, v, np.cross(first, v)]))
    return found


def enclosing_box(points: Array) -> tuple[Array, Array, Array]:
    """Return a small box that encloses some points.

    Args:
        points: Shape (n, 3), n >= 1 [m].

    Returns:
        Its axes, one a row, shape (3, 3), its centre, shape (3,) [m], and half its edges, shape
        (3,) [m].
    """
    return _box_of(np.ascontiguousarray(points, dtype=np.float64).tobytes())


def covering_spheres(points: Array) -> Array:
    """Return spheres that together cover the hull of some points, shape (s, 4): centre, radius [m].

    The hull is cut into slices across its longest side; each sphere holds the corners of a slice
    and with them, being convex, all of it.

    Args:
        points: Shape (n, 3), n >= 1 [m].
    """
    return _spheres_of(np.ascontiguousarray(points, dtype=np.float64).tobytes())


@functools.lru_cache(maxsize=1024)
def _spheres_of(content: bytes) -> Array:
    points = np.frombuffer(content).reshape(-1, 3)
    axes, _, half = _box_of(content)
    order = np.argsort(-half, kind="stable")
    wide = max(float(half[order[1]]), 1e-6)
    count = min(max(math.ceil(1.5 * float(half[order[0]]) / wide), 1), _MOST_SPHERES)
    along = points @ axes[order[0]]
    cuts = np.linspace(along.min(), along.max(), count + 1)
    cuts[0], cuts[-1] = -math.inf, math.inf
    on_cuts = [_at(points, along, cut) for cut in cuts]
    spheres = []
    for k in range(count):
        inside = points[(along >= cuts[k]) & (along <= cuts[k + 1])]
        corners = np.concatenate([inside, on_cuts[k], on_cuts[k + 1]])
        spheres.append(_sphere_about(corners))
    return np.array(spheres)


def _at(points: Array, along: Array, cut: float) -> Array:
    """Corners of the cut of a hull by a plane: where the lines between its points meet it."""
    if not math.isfinite(cut):
        return np.empty((0, 3))
    below, above = np.flatnonzero(along < cut), np.flatnonzero(along > cut)
    share = (cut - along[below])[:, None] / (along[above][None] - along[below][:, None])
    steps = points[above][None] - points[below][:, None]
    return np.asarray((points[below][:, None] + share[:, :, None] * steps).reshape(-1, 3))


def _sphere_about(points: Array) -> Array:
    """A small sphere about points (M. Badoiu and K. L. Clarkson, 2003), shape (4,)."""
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    farthest = _Farthest(points, centre)
    best, radius = centre, math.inf
    for step in range(1, _STEPS):
        far, distance = farthest.from_point(centre)
        if distance < radius:
            best, radius = centre, distance
        centre = centre + (points[far] - centre) / (step + 1)
    return np.append(best, radius * (1.0 + 1e-12) + _ROUNDING)


class _Farthest:
    """Which of some points is the farthest: of many, few are compared exactly."""

    def __init__(self, points: Array, middle: Array) -> None:
        self._points, self._middle = points, middle
        self._offsets = points - middle
        self._squares = np.einsum("ij,ij->i", self._offsets, self._offsets)
        self._alike = _ALIKE * float(self._squares.max())
        self._nearly = np.empty(len(points))

    def from_point(self, centre: Array) -> tuple[int, float]:
        """Return the first of the points that are the farthest, and its distance [m]."""
        if len(self._points) <= _FEW:
            distance = lengths_of(self._points - centre)
            far = int(np.argmax(distance))
            return far, float(distance[far])
        # The squares of the distances, but for what all points share, to a rounding.
        nearly = np.dot(self._offsets, 2.0 * (centre - self._middle), out=self._nearly)
        np.subtract(self._squares, nearly, out=nearly)
        among = np.flatnonzero(nearly >= nearly.max() - self._alike)
        distance = lengths_of(self._points[among] - centre)
        far = int(np.argmax(distance))
        return int(among[far]), float(distance[far])


@leaf_kernel
def sphere_box_gap(x: float, y: float, z: float, box: Array, half: Array) -> float:
    """Return the distance of a point from a box [m]; 0 inside.

    Args:
        x: The point.
        y: The point.
        z: The point [m].
        box: Axes of the box, one a row, and its centre, shape (12,) [m].
        half: Half its edges, shape (3,) [m].
    """
    dx, dy, dz = x - box[9], y - box[10], z - box[11]
    square = 0.0
    for k in range(3):
        beyond = abs(dx * box[3 * k] + dy * box[3 * k + 1] + dz * box[3 * k + 2]) - half[k]
        if beyond > 0.0:
            square += beyond * beyond
    return math.sqrt(square)
