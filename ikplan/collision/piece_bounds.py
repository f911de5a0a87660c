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

__all__ = ["PieceBounds", "bounds_of"]


class PieceBounds(NamedTuple):
    """A convex piece in the frame of its carrier, and what encloses it.

    Attributes:
        points: Its points, shape (n, 3) [m].
        sphere: Centre and radius of a sphere about it, shape (4,) [m].
        capsule: Both ends and the radius of a capsule about it, shape (7,) [m].
        spheres: Spheres that cover it: centre and radius, shape (s, 4) [m].
        box: Axes, one a row, and centre of a box about its points, shape (12,) [m].
        half: Half the edges of that box, shape (3,) [m].
    """

    points: Array
    sphere: Array
    capsule: Array
    spheres: Array
    box: Array
    half: Array


def bounds_of(body: Body, T: pin.SE3) -> tuple[PieceBounds, ...]:
    """Return the pieces of a body and their bounds.

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
    found = []
    for piece in body.pieces:
        points = np.asarray(piece.points, dtype=np.float64) @ R.T + p
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        reach = float(np.linalg.norm(points - middle, axis=1).max())
        begin, end, wide = (middle, middle, reach) if standing else enclosing_capsule(points)
        ball = np.append(middle, reach)
        cover = ball[None] if standing else covering_spheres(points)
        axes, centre, half = enclosing_box(points)
        found.append(
            PieceBounds(
                points,
                ball + np.array([0.0, 0.0, 0.0, piece.radius]),
                np.concatenate([begin, end, [wide + piece.radius]]),
                cover + np.array([0.0, 0.0, 0.0, piece.radius]),
                np.append(axes.ravel(), centre),
                half,
            )
        )
    return tuple(found)


_link_bounds = functools.lru_cache(maxsize=1024)(_bounds)
