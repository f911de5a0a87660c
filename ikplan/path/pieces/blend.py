"""Corners rounded within a radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.path.curves.arc_length import ArcLength
from ikplan.path.curves.shapes import QuinticShape
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.piece import PathDerivatives, Piece
from ikplan.path.pieces.turning import BlendTurning
from ikplan.path.rotation.so3 import angle_between

__all__ = ["Blend", "blend_corner"]


@dataclass(frozen=True)
class Blend:
    """A rounded corner.

    Attributes:
        piece: The blend.
        radius: Radius of the ball about the corner that it is in [m].
        reach: How much of either side it replaces [m].
        nearest: Length from the blend's begin of the pose nearest to the corner [m].
        deviation: Distance of that pose from the corner [m].
        rotation: Its rotation from the corner's orientation [rad]; 0 where that is free.
    """

    piece: Piece
    radius: float
    reach: float
    nearest: float
    deviation: float
    rotation: float


def blend_corner(before: Piece, after: Piece, radius: float) -> Blend:
    """Round the corner between two pieces within a ball around it.

    At most ``radius`` of either piece is replaced by a quintic with the positions, directions and
    curvatures of both where it meets them; its control points, and so all of it, are inside the
    ball. The orientation goes over from the steady turning of one to that of the other.

    Args:
        before: The piece that ends at the corner.
        after: The piece that begins there.
        radius: Radius of the ball, at most the length of either piece [m].
    """
    reach = radius
    for _ in range(40):
        a = before.evaluate(np.array([before.length - reach]))
        b = after.evaluate(np.array([reach, 0.0]))
        corner = b.p[1]
        # Run through at the speed of the path where it leaves and joins it.
        shape = QuinticShape(_end(a, 2.0 * reach), _end(b, 2.0 * reach))
        if (np.linalg.norm(shape.control_points - corner, axis=1) <= radius * (1.0 + 1e-9)).all():
            break
        reach *= 0.8
    turning = None
    if before.oriented and after.oriented:
        rates = [2.0 * reach * (m.R[0].T @ m.w[0]) for m in (a, b)]
        turning = BlendTurning(a.R[0], rates[0], b.R[0], rates[1])
    curve = ArcLength(shape)
    piece = CurvedPiece.whole(curve, turning)
    nearest = curve.length_at(_nearest(shape, corner))
    at = piece.evaluate(np.array([nearest]))
    rotation = 0.0
    if turning is not None:
        rotation = float(angle_between(at.R[0], b.R[1]))
    deviation = float(np.linalg.norm(at.p[0] - corner))
    return Blend(piece, radius, reach, nearest, deviation, rotation)


def _end(derivatives: PathDerivatives, scale: float) -> Array:
    """Position and derivatives by a parameter of which one unit is ``scale`` metres."""
    return np.array(
        [derivatives.p[0], scale * derivatives.v[0], scale * scale * derivatives.bend[0]]
    )


def _nearest(shape: QuinticShape, corner: Array) -> float:
    """Parameter in [0, 1] at which the shape is nearest to the corner."""
    t = np.linspace(0.0, 1.0, 65)
    k = int(np.argmin(np.linalg.norm(shape.derivatives(t)[0] - corner, axis=1)))
    low, at, high = t[max(k - 1, 0)], t[k], t[min(k + 1, 64)]
    for _ in range(40):
        p, first, second = (d[0] for d in shape.derivatives(np.array([at])))
        slope = float((p - corner) @ first)
        low, high = (low, at) if slope > 0.0 else (at, high)
        step = at - slope / max(float(first @ first + (p - corner) @ second), 1e-300)
        before, at = at, step if low < step < high else 0.5 * (low + high)
        if abs(at - before) < 1e-13:
            break
    return float(at)
