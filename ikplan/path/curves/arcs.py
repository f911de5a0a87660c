"""Circular arcs: through a point, or about an axis."""

from __future__ import annotations

import math

import numpy as np

from ikplan.arrays import Array
from ikplan.path.coincidence import COINCIDENT
from ikplan.path.pieces.piece import unit
from ikplan.path.pieces.steady import SteadyPiece, line

__all__ = ["arc_about", "arc_around", "arc_between", "arc_through", "helix_about"]


_STRAIGHT = 1e-9
"""An arc that bulges by less than this [m] is a line."""


_LEAST_RADIUS = 1e-6
"""A circle of a smaller radius is no path [m]."""
_UNEVEN = 1e-3
"""How much the distances of both ends from a centre may differ, as a share of the radius."""
_HALF_TURN = 1e-3
"""An angle this near to half a turn does not tell which way round an arc goes [rad]."""


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
    _refuse_microscopic(0.5 * length / half)
    return _steady(p0, t, n, np.zeros(3), 1.0, 2.0 * half / length, length)


def arc_around(p0: Array, centre: Array, p1: Array) -> SteadyPiece:
    """Return the arc from p0 to p1 around a centre, the shorter way.

    Args:
        p0: First point, shape (3,) [m].
        centre: Centre of the circle, as far from p0 as from p1 but for a thousandth, shape (3,).
        p1: Last point, shape (3,) [m].

    Raises:
        ValueError: The points do not make one arc; says why.
    """
    a, b = float(np.linalg.norm(p0 - centre)), float(np.linalg.norm(p1 - centre))
    _refuse_microscopic(min(a, b))
    if abs(a - b) > _UNEVEN * max(a, b):
        raise ValueError(
            f"its ends are {a:.6g} m and {b:.6g} m from its centre, and not as far as each other"
        )
    chord = p1 - p0
    if np.linalg.norm(chord) <= COINCIDENT:
        raise ValueError("its ends coincide; a full circle is an arc by centre and angle")
    along = unit(chord)
    middle = 0.5 * (p0 + p1)
    # From the point of the middle plane nearest to the centre given, towards the chord.
    out = (middle - centre) - float((middle - centre) @ along) * along
    radius = math.hypot(float(np.linalg.norm(out)), 0.5 * float(np.linalg.norm(chord)))
    if np.linalg.norm(out) <= 0.5 * _HALF_TURN * radius:
        raise ValueError(
            "it is half a turn, and could go either way; give via and to, or centre and angle"
        )
    return arc_through(p0, middle - out + radius * unit(out), p1)


def arc_between(p0: Array, centre: Array, p1: Array, z: Array) -> SteadyPiece:
    """Return the arc from p0 to p1 that turns right-handed about an axis.

    It lies across the axis, but for what the chord leans towards it; its centre is where both
    ends are equally far from it.

    Args:
        p0: First point, shape (3,) [m].
        centre: Any point of the axis, shape (3,) [m].
        p1: Last point, shape (3,) [m].
        z: Unit direction of the axis, shape (3,).

    Raises:
        ValueError: The points do not make one arc; says why.
    """
    chord, middle = p1 - p0, 0.5 * (p0 + p1)
    half = 0.5 * float(np.linalg.norm(chord))
    if 2.0 * half <= COINCIDENT:
        raise ValueError("its ends coincide; a full circle is an arc by centre and angle")
    along = unit(chord)
    lean = float(z @ along)
    if abs(lean) > _UNEVEN:
        raise ValueError("its ends are not level: one is farther along the axis than the other")
    n = unit(z - lean * along)
    left = np.cross(n, along)
    hub = centre - middle
    height = float(hub @ left)
    radius = math.hypot(height, half)
    _refuse_microscopic(radius)
    # Where the axis passes the plane of the arc, however far along it the centre is given.
    uneven = float(hub @ along) - lean * float(hub @ n) / float(z @ n)
    if abs(uneven) > _UNEVEN * radius:
        a, b = (float(np.linalg.norm(np.cross(p - centre, z))) for p in (p0, p1))
        raise ValueError(
            f"its ends are {a:.6g} m and {b:.6g} m from its axis, and not as far as each other"
        )
    spoke = p0 - middle - height * left
    end = p1 - middle - height * left
    angle = math.atan2(float(n @ np.cross(spoke, end)), float(spoke @ end)) % (2.0 * math.pi)
    return helix_about(p0, spoke, n, angle, 0.0)


def _refuse_microscopic(radius: float) -> None:
    if radius < _LEAST_RADIUS:
        raise ValueError(f"its radius of {radius:.3g} m is below {_LEAST_RADIUS:g} m")


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
    _refuse_microscopic(float(np.linalg.norm(spoke)))
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
