"""The named curves of a request, drawn in their frame, without an orientation."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.requested.arc_length import ArcLength
from ikplan.certificate.requested.curves import Curve, RoseCurve, SinusoidCurve
from ikplan.certificate.requested.pieces import CurvePiece, Piece, helix, line
from ikplan.documents.curve import (
    CircleSegment,
    CurveSegment,
    HelixSegment,
    RoseSegment,
    SawtoothSegment,
    SinusoidSegment,
    TrapezoidSegment,
)

__all__ = ["curve_pieces"]


def curve_pieces(segment: CurveSegment, R: Array, origin: Array) -> list[Piece]:
    """Return the pieces of a curve.

    Args:
        segment: The curve.
        R: Rotation of its frame in the base, shape (3, 3).
        origin: Origin of its frame in the base, shape (3,) [m].

    Raises:
        TypeError: No curve of that class.
    """
    if isinstance(segment, CircleSegment):
        return [_helix(segment.radius, segment.phase, segment.angle, 0.0, R, origin)]
    if isinstance(segment, HelixSegment):
        angle = 2.0 * math.pi * segment.turns
        return [_helix(segment.radius, segment.phase, angle, segment.rise, R, origin)]
    if isinstance(segment, RoseSegment):
        swept = segment.angle
        if swept is None:
            swept = math.pi if segment.petals % 2 == 1 else 2.0 * math.pi
        rose = RoseCurve(R, origin, segment.radius, segment.petals, segment.phase, swept)
        return [_whole(rose)]
    if isinstance(segment, SinusoidSegment):
        return [
            _whole(
                SinusoidCurve(
                    R,
                    origin,
                    segment.length,
                    segment.amplitude,
                    segment.wavelength,
                    segment.phase,
                )
            )
        ]
    if isinstance(segment, SawtoothSegment):
        tooth = [(0.0, 0.0), (1.0 - segment.fall, segment.height), (1.0, 0.0)]
        return _repeated(tooth, segment.teeth, segment.length, R, origin)
    if isinstance(segment, TrapezoidSegment):
        ramp, height = segment.ramp, segment.height
        period = [(0.0, 0.0), (ramp, height), (0.5, height), (0.5 + ramp, 0.0), (1.0, 0.0)]
        return _repeated(period, segment.periods, segment.length, R, origin)
    raise TypeError(f"no curve: {type(segment).__name__}")


def _helix(
    radius: float, phase: float, angle: float, rise: float, R: Array, origin: Array
) -> Piece:
    spoke = radius * (math.cos(phase) * R[:, 0] + math.sin(phase) * R[:, 1])
    return helix(origin + spoke, spoke, R[:, 2], angle, rise)


def _whole(curve: Curve) -> Piece:
    arc = ArcLength(curve)
    return CurvePiece(arc, 0.0, arc.length)


def _repeated(
    corners: list[tuple[float, float]], count: int, length: float, R: Array, origin: Array
) -> list[Piece]:
    """Lines through the corners of one period (share of it, height), ``count`` times along x."""
    period = length / count
    points = [
        origin + (k + x) * period * R[:, 0] + y * R[:, 1]
        for k in range(count)
        for x, y in (corners if k == 0 else corners[1:])
    ]
    steps = ((a, b) for a, b in pairwise(points))
    # Where a flank or a top has no width, two corners are one point.
    return [line(a, b) for a, b in steps if np.linalg.norm(b - a) > 1e-12]
