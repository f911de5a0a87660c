"""Cheap bounds about the convex pieces of a body, in the frame of the chain's link."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ikplan.arrays import Array
from ikplan.collision.capsules import enclosing_capsule
from ikplan.collision.coverings import covering_spheres, enclosing_box
from ikplan.scene.body import Body
from ikplan.scene.hulls import hull_of

__all__ = ["PieceBounds", "bounds_of"]

_ROUNDING = 1e-9
"""Added to the radius about several pieces, since a hull may lack points by its rounding [m]."""


class PieceBounds(NamedTuple):
    """A convex piece in the frame of its carrier, and what encloses it.

    Attributes:
        points: Its points, shape (n, 3) [m].
        radius: What it reaches beyond their hull [m].
        sphere: Centre and radius of a sphere about it, shape (4,) [m].
        capsule: Both ends and the radius of a capsule about it, shape (7,) [m].
        spheres: Spheres that cover it: centre and radius, shape (s, 4) [m].
        box: Axes, one a row, and centre of a box about its points, shape (12,) [m].
        half: Half the edges of that box, shape (3,) [m].
    """

    points: Array
    radius: float
    sphere: Array
    capsule: Array
    spheres: Array
    box: Array
    half: Array


def bounds_of(body: Body, T: pin.SE3) -> tuple[PieceBounds, ...]:
    """Return the bounds of the pieces of a body and, last, where it has several, of all together.

    Args:
        body: The body.
        T: Pose of the frame of its carrier in that of the chain's link.
    """
    # Links of robots are the same bodies from request to request.
    placed = _link_bounds if body.kind == "link" else _bounds
    return placed(body, T.rotation.tobytes("F"), T.translation.tobytes())


def _bounds(body: Body, rotation: bytes, translation: bytes) -> tuple[PieceBounds, ...]:
    R, p = np.frombuffer(rotation).reshape(3, 3, order="F"), np.frombuffer(translation)
    standing = body.carrier == 0  # what stands is bounded by its box
    placed = [np.asarray(piece.points, dtype=np.float64) @ R.T + p for piece in body.pieces]
    found = [
        _bounds_of_piece(points, piece.radius, standing)
        for points, piece in zip(placed, body.pieces, strict=True)
    ]
    if len(placed) > 1:
        widest = max(piece.radius for piece in body.pieces) + _ROUNDING
        found.append(_bounds_of_piece(_corners(np.concatenate(placed)), widest, standing))
    return tuple(found)


def _corners(points: Array) -> Array:
    """Return the corners of the hull of some points, or all of them where they are flat."""
    hull = hull_of(points)
    return points if hull is None else np.asarray(points[hull.vertices])


def _bounds_of_piece(points: Array, radius: float, standing: bool) -> PieceBounds:
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    reach = float(np.linalg.norm(points - middle, axis=1).max())
    begin, end, wide = (middle, middle, reach) if standing else enclosing_capsule(points)
    cover = np.append(middle, reach)[None] if standing else covering_spheres(points)
    # Their centres move as little as the points only where they are as near to the middle.
    reach = max(reach, float(np.linalg.norm(cover[:, :3] - middle, axis=1).max()))
    ball = np.append(middle, reach)
    axes, centre, half = enclosing_box(points)
    return PieceBounds(
        points,
        radius,
        ball + np.array([0.0, 0.0, 0.0, radius]),
        np.concatenate([begin, end, [wide + radius]]),
        cover + np.array([0.0, 0.0, 0.0, radius]),
        np.append(axes.ravel(), centre),
        half,
    )


_link_bounds = functools.lru_cache(maxsize=1024)(_bounds)
