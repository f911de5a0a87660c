"""Named curves as pieces, drawn in a frame of their own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.curve import (
    CircleSegment,
    CurveSegment,
    HelixSegment,
    RoseSegment,
    SawtoothSegment,
    SinusoidSegment,
    TrapezoidSegment,
)
from ikplan.path.coincidence import joined
from ikplan.path.curves.arc_length import ArcLength
from ikplan.path.curves.arcs import helix_about
from ikplan.path.curves.shapes import RoseShape, SinusoidShape
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.piece import Piece, Pose
from ikplan.path.pieces.steady import line

__all__ = ["curve_pieces"]


def curve_pieces(segment: CurveSegment, R: Array, origin: Array) -> list[Piece]:
    """Return the pieces of a named curve, without orientation.

    Args:
        segment: The curve.
        R: Rotation of the curve's frame in the base, shape (3, 3).
        origin: Origin of the curve's frame in the base, shape (3,) [m].

    Raises:
        TypeError: No curve of that class.
    """
    match segment:
        case CircleSegment():
            return [_turning(R, origin, segment.radius, segment.phase, segment.angle, 0.0)]
        case HelixSegment():
            angle = 2.0 * math.pi * segment.turns
            rise = segment.rise
            return [_turning(R, origin, segment.radius, segment.phase, angle, rise)]
        case RoseSegment():
            whole = math.pi if segment.petals % 2 else 2.0 * math.pi
            angle = whole if segment.angle is None else segment.angle
            rose = RoseShape(origin, R, segment.radius, segment.petals, segment.phase, angle)
            return [CurvedPiece.whole(ArcLength(rose))]
        case SinusoidSegment():
            wave = SinusoidShape(
                origin, R, segment.length, segment.amplitude, segment.wavelength, segment.phase
            )
            return [CurvedPiece.whole(ArcLength(wave))]
        case SawtoothSegment():
            top = [(0.0, 0.0), (1.0 - segment.fall, segment.height)]
            return _periodic(R, origin, segment.length, segment.teeth, top)
        case TrapezoidSegment():
            ramp, height = segment.ramp, segment.height
            top = [(0.0, 0.0), (ramp, height), (0.5, height), (0.5 + ramp, 0.0)]
            return _periodic(R, origin, segment.length, segment.periods, top)
        case _:
            raise TypeError(f"no curve: {type(segment).__name__}")


def _turning(
    R: Array, origin: Array, radius: float, phase: float, angle: float, rise: float
) -> Piece:
    spoke = R @ np.array([radius * math.cos(phase), radius * math.sin(phase), 0.0])
    return helix_about(origin + spoke, spoke, R[:, 2], angle, rise)


def _periodic(
    R: Array, origin: Array, length: float, periods: int, corners: Sequence[tuple[float, float]]
) -> list[Piece]:
    """Lines through corners (share of the period, height), repeated along x."""
    period = length / periods
    points = [(period * (k + x), y) for k in range(periods) for x, y in corners]
    points.append((length, 0.0))
    corners_in_base = [Pose(None, origin + R @ np.array([x, y, 0.0])) for x, y in points]
    pieces = [line(a.p, b.p) for a, b in pairwise(joined(corners_in_base))]
    # A flank or a top of no width leaves two corners in one place.
    return [piece for piece in pieces if piece.length > 0.0]
