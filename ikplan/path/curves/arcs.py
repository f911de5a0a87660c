"""Circular arcs: through a point, or about an axis."""

from __future__ import annotations

import math

import numpy as np

from ikplan.arrays import Array
from ikplan.path.coincidence import COINCIDENT
from ikplan.path.pieces.piece import unit
from ikplan.path.pieces.steady import SteadyPiece, line

__all__ = ["arc_about", "arc_through", "helix_about"]


_STRAIGHT = 1e-9
"""An arc that bulges by less than this [m] is a line."""


def arc_through(p0: Array, via: Array, p1: Array) -> SteadyPiece:
    """Return the circular arc from p0 through ``via`` to p1.

    The inversion about p0 makes the circle a line, whose direction is the tangent at p0; this
    stays exact for arcs that are almost straight.

    Args:
        p0: First point, shape (3,) [m].
        via: A point on the way, shape (3,) [m].
        p1: Last point, shape (3,) [m].

    Returns:
        The arc, or the line where the three points are on one.

    Raises:
        ValueError: The points do not make one arc; says why.
    """
    a, b = via - p0, p1 - p0
    if min(float(np.linalg.norm(x)) for x in (a, b, p1 - via)) <= COINCIDENT:
        raise ValueError(
            "two of its three points coincide; a full circle is a `circle`, or an arc by centre "
            "and angle"
        )
    chord = unit(b)
    along = float(a @ chord)
    if np.linalg.norm(a - along * chord) < _STRAIGHT:
        if not 0.0 < along < float(np.linalg.norm(b)):
            raise ValueError("its three points are on a line, and via is not between the ends")
        return line(p0, p1)
    t = unit(a / float(a @ a) - b / float(b @ b))
    side = b - float(b @ t) * t
    if np.linalg.norm(side) <= 1e-12 * np.linalg.norm(b):
        # The end is behind the begin: only via tells the side, and the circle is all but a line.
        raise ValueError("its circle is too large to be told from a line")
    n = unit(side - float(side @ t) * t)
    half = math.atan2(float(np.linalg.norm(side)), float(b @ t))
    length = float(np.linalg.norm(b)) * half / math.sin(half)
    return _steady(p0, t, n, np.zeros(3), 1.0, 2.0 * half / length, length)


def arc_about(p0: Array, centre: Array, z: Array, angle: float) -> SteadyPiece:
    """Return the arc that begins at p0 and turns about the axis through ``centre``.

    Args:
        p0: First point, shape (3,) [m].
        centre: Any point of the axis, shape (3,) [m].
        z: Unit direction of the axis, shape (3,).
        angle: Angle turned, signed [rad].

    Raises:
        ValueError: p0 is on the axis, or the arc is so short that its ends coincide.
    """
    spoke = p0 - centre
    spoke = spoke - float(spoke @ z) * z
    if np.linalg.norm(spoke) <= COINCIDENT:
        raise ValueError("it begins on its own axis")
    arc = helix_about(p0, spoke, z, angle, 0.0)
    if arc.length <= COINCIDENT:
        raise ValueError(f"it is no longer than {COINCIDENT:g} m: a point, not a path")
    return arc


def helix_about(p0: Array, spoke: Array, z: Array, angle: float, rise: float) -> SteadyPiece:
    """Return the helix that begins at p0, at ``spoke`` from its axis.

    Args:
        p0: First point, shape (3,) [m].
        spoke: From the axis to p0, across the axis, shape (3,) [m].
        z: Unit direction of the axis, shape (3,).
        angle: Angle turned about z, signed, not 0 [rad].
        rise: Way along z [m].
    """
    radius = float(np.linalg.norm(spoke))
    length = math.hypot(radius * angle, rise)
    t = math.copysign(1.0, angle) * np.cross(z, spoke) / radius
    h, k = radius * abs(angle) / length, abs(angle) / length
    return _steady(p0, t, -spoke / radius, z * (rise / length), h, k, length)


def _steady(
    p0: Array, t: Array, n: Array, c: Array, h: float, k: float, length: float
) -> SteadyPiece:
    return SteadyPiece(p0, t, n, c, h, k, length, np.eye(3), np.zeros(3))
