"""The bodies of a collision model as flat arrays."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import leaf_kernel
from ikplan.errors import InvalidRequest
from ikplan.scene.body import Body, CollisionModel

__all__ = ["PieceArrays", "PiecePairs", "bounding_sphere", "piece_pairs", "pieces_of"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_STEPS = 200
"""Steps towards the least sphere; any sphere of any step holds the points."""


class PieceArrays(NamedTuple):
    """Every convex piece of every body.

    Attributes:
        xyz: Corners of the hulls by coordinate, shape (3, n) [m], in their carriers' frames.
        start: Where the corners of each piece begin, shape (pieces + 1,).
        radius: Radii around the hulls, shape (pieces,) [m].
        carrier: Carrier of each piece, shape (pieces,).
        centre: Centres of their bounding spheres, each a point of its hull, shape (pieces, 3) [m].
        size: Radii of those spheres, around the hull alone, shape (pieces,) [m].
        body: Body of each piece, shape (pieces,).
    """

    xyz: Array
    start: Ints
    radius: Array
    carrier: Ints
    centre: Array
    size: Array
    body: Ints


class PiecePairs(NamedTuple):
    """Pairs of pieces to be kept apart.

    Attributes:
        first: Piece whose carrier is nearer to the base, shape (n,).
        second: The other, shape (n,).
        group: 0: the robot against itself; 1: against obstacles, shape (n,).
        pair: Row of the model's pairs, shape (n,).
    """

    first: Ints
    second: Ints
    group: Ints
    pair: Ints


def bounding_sphere(points: Array) -> tuple[Array, float]:
    """Return a small sphere around points, centred in their hull.

    Badoiu and Clarkson (Comput. Geom. 2008): steps of length 1 / k towards the farthest point.
    The centre stays an average of points, and the radius is measured at the end.

    Args:
        points: Shape (n, 3) [m].

    Returns:
        Centre, shape (3,), and radius [m].
    """
    centre = np.zeros(3)
    size = _enclose(np.ascontiguousarray(points, dtype=np.float64), centre)
    return centre, size


@leaf_kernel
def _enclose(points: Array, best: Array) -> float:
    """Set the best centre, and return the radius of the sphere around it."""
    x = y = z = 0.0
    for i in range(points.shape[0]):
        x += points[i, 0] / points.shape[0]
        y += points[i, 1] / points.shape[0]
        z += points[i, 2] / points.shape[0]
    least = np.inf
    for k in range(1, _STEPS + 1):
        far, squared = 0, -1.0
        for i in range(points.shape[0]):
            d = (points[i, 0] - x) ** 2 + (points[i, 1] - y) ** 2 + (points[i, 2] - z) ** 2
            if d > squared:
                far, squared = i, d
        if squared < least:
            best[0], best[1], best[2] = x, y, z
            least = squared
        x += (points[far, 0] - x) / (k + 1.0)
        y += (points[far, 1] - y) / (k + 1.0)
        z += (points[far, 2] - z) / (k + 1.0)
    return float(np.sqrt(least))


def _spheres(body: Body) -> tuple[tuple[Array, float], ...]:
    return tuple(bounding_sphere(np.asarray(piece.points)) for piece in body.pieces)


_link_spheres = functools.lru_cache(maxsize=1024)(_spheres)
"""Of the links of robots, which are the same bodies from request to request."""


def pieces_of(model: CollisionModel, carriers: int) -> PieceArrays:
    """Return the pieces of a model.

    Args:
        model: The bodies.
        carriers: How many carriers there are: the base and every serial joint.

    Raises:
        InvalidRequest: A body has no piece, a carrier that is not there, or points or a radius
            that are no numbers.
    """
    points: list[Array] = []
    rows: list[tuple[float, int, int]] = []
    for b, body in enumerate(model.bodies):
        if not 0 <= body.carrier < carriers or not body.pieces:
            raise InvalidRequest(
                f"body {body.name!r} has carrier {body.carrier} and {len(body.pieces)} piece(s); "
                f"carriers are 0 to {carriers - 1}, and a body has a piece",
                field=f"bodies[{b}]",
                allowed=list(range(carriers)),
            )
        for piece in body.pieces:
            corners = np.asarray(piece.points, dtype=np.float64)
            valid = corners.ndim == 2 and corners.shape[1:] == (3,) and len(corners) > 0
            if not valid or not np.isfinite(corners).all() or not 0.0 <= piece.radius < np.inf:
                raise InvalidRequest(
                    f"body {body.name!r} has a piece without points or a radius",
                    field=f"bodies[{b}].pieces",
                    allowed="points of shape (n, 3) [m] and a radius of at least 0 [m]",
                )
            points.append(corners)
            rows.append((float(piece.radius), body.carrier, b))
    spheres = [
        sphere
        for body in model.bodies
        for sphere in (_link_spheres(body) if body.kind == "link" else _spheres(body))
    ]
    joined = np.concatenate(points) if points else np.zeros((0, 3))
    return PieceArrays(
        np.ascontiguousarray(joined.T),
        np.cumsum([0, *(len(corners) for corners in points)]).astype(np.int64),
        np.array([row[0] for row in rows], dtype=np.float64),
        np.array([row[1] for row in rows], dtype=np.int64),
        np.array([centre for centre, _ in spheres], dtype=np.float64).reshape(-1, 3),
        np.array([size for _, size in spheres], dtype=np.float64),
        np.array([row[2] for row in rows], dtype=np.int64),
    )


def piece_pairs(model: CollisionModel, pieces: PieceArrays) -> PiecePairs:
    """Return every pair of pieces of the model's pairs of bodies.

    Raises:
        InvalidRequest: A pair names no two bodies, or two with one carrier.
    """
    by_body = [np.flatnonzero(pieces.body == b) for b in range(len(model.bodies))]
    rows: list[tuple[int, int, int, int]] = []
    for row, (a, b) in enumerate(np.asarray(model.pairs, dtype=np.int64).reshape(-1, 2).tolist()):
        if not (0 <= a < len(model.bodies) and 0 <= b < len(model.bodies)):
            raise InvalidRequest(
                f"pair {row} names bodies {a} and {b}; there are {len(model.bodies)}",
                field=f"pairs[{row}]",
                allowed=list(range(len(model.bodies))),
            )
        first, second = model.bodies[a], model.bodies[b]
        if first.carrier == second.carrier:
            raise InvalidRequest(
                f"{first.name!r} and {second.name!r} are both carried by {first.carrier}: no "
                "motion changes their distance",
                field=f"pairs[{row}]",
                allowed="two bodies of different carriers",
            )
        if first.carrier > second.carrier:
            a, b = b, a
        group = int("obstacle" in (first.kind, second.kind))
        rows += [(i, j, group, row) for i in by_body[a].tolist() for j in by_body[b].tolist()]
    columns = np.array(rows, dtype=np.int64).reshape(-1, 4).T
    return PiecePairs(*(np.ascontiguousarray(column) for column in columns))
