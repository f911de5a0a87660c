"""Circular arcs of G-code: centre, angle and plane from the words of a line."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.gcode.blocks import Block, fault

__all__ = ["Arc", "arc_of"]

# The axes of each plane, so that the third is its normal by the right-hand rule.
_PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
_OFFSETS = ("I", "J", "K")
# Programs are rounded to micrometres or tenths of a thousandth of an inch, on both radii.
_ROUNDED = 1e-5
_SHARE = 1e-3


@dataclass(frozen=True)
class Arc:
    """An arc about an axis of the frame.

    Attributes:
        centre: In the plane of the start, shape (3,) [m].
        normal: 0, 1 or 2: the axis of the frame about which it turns.
        angle: Signed [rad].
        rise: How far it moves along the axis meanwhile [m].
    """

    centre: Array
    normal: int
    angle: float
    rise: float


def arc_of(
    block: Block,
    start: Array,
    end: Array,
    clockwise: bool,
    plane: int,
    unit: float,
    incremental: bool,
) -> Arc:
    """Return the arc of a line with G2 or G3.

    Args:
        block: The line, with I, J and K or with R.
        start: Where the tool is, shape (3,) [m].
        end: Where it goes, shape (3,) [m].
        clockwise: G2, seen against the plane's normal.
        plane: 17, 18 or 19.
        unit: Metres in a unit of length.
        incremental: Whether I, J and K count from the start (G91.1), else from the origin.

    Raises:
        InvalidRequest: There is no such arc; names the line.
    """
    a, b, normal = _PLANES[plane]
    offsets = [block.value(letter) for letter in _OFFSETS]
    radius = block.value("R")
    if offsets[normal] is not None:
        raise fault(block.line, f"{_OFFSETS[normal]} is along the axis of the arc's plane")
    if (radius is None) == (offsets[a] is None and offsets[b] is None):
        raise fault(block.line, "an arc has a centre (I, J, K) or a radius (R)")
    u, v = start[[a, b]], end[[a, b]]
    sense = -1.0 if clockwise else 1.0
    if radius is not None:
        middle = _centre_by_radius(block.line, u, v, radius * unit, sense)
    else:
        given = [0.0 if offsets[k] is None else float(offsets[k] or 0.0) * unit for k in (a, b)]
        middle = np.array(given) + (u if incremental else 0.0)
        middle = _centre_between(block.line, u, v, middle)
    angle = _angle(u - middle, v - middle, sense)
    centre = np.array(start)
    centre[[a, b]] = middle
    return Arc(centre, normal, angle, float(end[normal] - start[normal]))


def _centre_by_radius(line: int, u: Array, v: Array, radius: float, sense: float) -> Array:
    chord = v - u
    length = float(np.hypot(*chord))
    if length < 1e-12:
        raise fault(line, "a whole circle has no radius form; give its centre by I, J, K")
    height2 = radius**2 - length**2 / 4.0
    if height2 < -2.0 * abs(radius) * _ROUNDED:
        raise fault(line, "the radius is smaller than half of the way to the end")
    height = math.sqrt(max(height2, 0.0))
    left = np.array([-chord[1], chord[0]]) / length
    # The centre of the shorter arc lies to the left of a counterclockwise chord.
    return np.asarray((u + v) / 2.0 + math.copysign(height, radius) * sense * left)


def _centre_between(line: int, u: Array, v: Array, centre: Array) -> Array:
    """The centre, moved to where both ends are at the same distance from it."""
    r0, r1 = float(np.hypot(*(u - centre))), float(np.hypot(*(v - centre)))
    if r0 < 1e-9:
        raise fault(line, "the centre of the arc is its start")
    if abs(r1 - r0) > max(_ROUNDED, _SHARE * r0):
        raise fault(
            line, f"the end is {1e3 * r1:.4f} mm from the centre and the start {1e3 * r0:.4f} mm"
        )
    chord = v - u
    length2 = float(chord @ chord)
    if length2 < 1e-18:
        return centre
    off = float((centre - (u + v) / 2.0) @ chord) / length2
    return np.asarray(centre - off * chord)


def _angle(a: Array, b: Array, sense: float) -> float:
    """From one radius to another the way round that is asked for, (0, 2 pi] by its sense."""
    turned = math.atan2(float(a[0] * b[1] - a[1] * b[0]), float(a @ b)) * sense
    if float(np.hypot(*(a - b))) < 1e-9:
        return sense * 2.0 * math.pi
    return sense * (turned if turned > 0.0 else turned + 2.0 * math.pi)
