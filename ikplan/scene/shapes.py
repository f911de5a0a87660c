"""From shapes of documents to convex pieces that enclose them."""

from __future__ import annotations

import heapq
import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan.documents.shape import (
    BoxShape,
    CapsuleShape,
    ConvexShape,
    CylinderShape,
    MeshShape,
    PointsShape,
    Shape,
    SphereShape,
)
from ikplan.errors import InvalidRequest
from ikplan.scene.body import ConvexPiece
from ikplan.scene.hulls import enclosing_points

__all__ = ["Enclosed", "enclose", "prism", "transformed"]

Array = NDArray[np.float64]

MAX_PIECE_POINTS = 128
"""Most points of one piece made of a convex shape."""
_PRISM_EXCESS = 1e-3
"""Excess of a prism about a cylinder [m] below which it gets no more sides."""
_SIDES = (8, 32)
"""Fewest and most sides of such a prism."""
MAX_CLOUD_PIECES = 512
"""Most pieces of a point cloud."""


class Enclosed(NamedTuple):
    """Pieces that enclose a shape, and how far they reach beyond it [m]."""

    pieces: tuple[ConvexPiece, ...]
    excess: float


def enclose(shape: Shape, field: str = "shape") -> Enclosed:
    """Return convex pieces that enclose a shape, in the shape's frame.

    Args:
        shape: The shape.
        field: The field it is from, for messages.

    Raises:
        InvalidRequest: A mesh that was not read yet.
    """
    if isinstance(shape, BoxShape):
        x, y, z = (0.5 * edge for edge in shape.size)
        corners = [(i, j, k) for i in (-x, x) for j in (-y, y) for k in (-z, z)]
        return _one(np.array(corners), 0.0, 0.0)
    if isinstance(shape, SphereShape):
        return _one(np.zeros((1, 3)), shape.radius, 0.0)
    if isinstance(shape, CapsuleShape):
        h = 0.5 * shape.length
        return _one(np.array([(0.0, 0.0, -h), (0.0, 0.0, h)]), shape.radius, 0.0)
    if isinstance(shape, CylinderShape):
        return prism(shape.radius, shape.length)
    if isinstance(shape, ConvexShape):
        return _one(*enclosing_points(np.array(shape.points), MAX_PIECE_POINTS))
    if isinstance(shape, PointsShape):
        return _cloud(np.array(shape.points), shape.radius)
    assert isinstance(shape, MeshShape)
    raise InvalidRequest(
        f"{field}: the file {shape.file!r} is not read here; send its points as a convex shape, "
        "or read the file in Python, the shell or the client",
        field=field,
        allowed="a shape without a file",
    )


def prism(radius: float, length: float) -> Enclosed:
    """Return the prism about a cylinder along z, centred.

    Its sides touch the cylinder, so that its edges reach beyond it by the excess.
    """
    least = math.pi / math.acos(radius / (radius + _PRISM_EXCESS))
    sides = min(max(math.ceil(least), _SIDES[0]), _SIDES[1])
    outer = radius / math.cos(math.pi / sides) * (1.0 + 1e-15)
    angles = 2.0 * math.pi * np.arange(sides) / sides
    ring = np.column_stack([outer * np.cos(angles), outer * np.sin(angles), np.zeros(sides)])
    end = np.array([0.0, 0.0, 0.5 * length])
    return _one(np.concatenate([ring - end, ring + end]), 0.0, outer - radius)


def transformed(
    pieces: tuple[ConvexPiece, ...], R: Array, p: Array, padding: float = 0.0
) -> tuple[ConvexPiece, ...]:
    """Return pieces in another frame.

    Args:
        pieces: The pieces.
        R: Rotation from their frame to the other, shape (3, 3).
        p: Origin of their frame in the other, shape (3,) [m].
        padding: Added to their radius [m].
    """
    return tuple(ConvexPiece(x.points @ R.T + p, x.radius + padding) for x in pieces)


def _one(points: Array, radius: float, excess: float) -> Enclosed:
    return Enclosed((ConvexPiece(points, radius),), excess)


def _cloud(points: Array, radius: float) -> Enclosed:
    """A piece for each point; where there are many, one for each group of neighbours."""
    made = 0
    first = np.unique(points, axis=0)
    heap = [(-_width(first), 0, first)]
    while len(heap) < MAX_CLOUD_PIECES and heap[0][0] < 0.0:
        _, _, widest = heapq.heappop(heap)
        for half in _halves(widest):
            made += 1
            heapq.heappush(heap, (-_width(half), made, half))
    pieces, excess = [], 0.0
    for _, _, group in sorted(heap, key=lambda entry: entry[1]):
        low, high = group.min(axis=0), group.max(axis=0)
        if len(group) > 8:  # their box has no more corners than that
            group = np.array(list(itertools.product(*zip(low, high, strict=True))))
        pieces.append(ConvexPiece(group, radius))
        # A point of the piece is at most a diagonal from any point of the group.
        excess = max(excess, float(np.linalg.norm(high - low)))
    return Enclosed(tuple(pieces), excess)


def _width(group: Array) -> float:
    """Longest side of the box about points [m]."""
    return float(np.ptp(group, axis=0).max())


def _halves(group: Array) -> list[Array]:
    """Two parts of a group, split in the middle of its longest side."""
    low, high = group.min(axis=0), group.max(axis=0)
    axis = int(np.argmax(high - low))
    left = group[:, axis] <= 0.5 * (low[axis] + high[axis])
    return [group[left], group[~left]]
