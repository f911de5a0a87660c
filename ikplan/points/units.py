"""The units of a file of points: as written, as told, or guessed from the values."""

from __future__ import annotations

import math
from collections.abc import Iterable

from ikplan.errors import InvalidRequest
from ikplan.points.note import Note

__all__ = [
    "ANGLES",
    "LENGTHS",
    "SPEEDS",
    "TIMES",
    "guess_angle",
    "guess_length",
    "in_si",
    "unit_factor",
]

LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254}
"""Lengths in metres."""
ANGLES = {"rad": 1.0, "deg": math.pi / 180.0}
"""Angles in radians."""
SPEEDS = {
    "m/s": 1.0,
    "mm/s": 1e-3,
    "cm/s": 1e-2,
    "in/s": 0.0254,
    "m/min": 1.0 / 60.0,
    "mm/min": 1e-3 / 60.0,
    "in/min": 0.0254 / 60.0,
}
"""Speeds in m/s."""
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}
"""Times in seconds."""

_WORDS = {
    "meter": "m", "meters": "m", "metre": "m", "metres": "m",
    "millimeter": "mm", "millimeters": "mm", "millimetre": "mm", "millimetres": "mm",
    "centimeter": "cm", "centimeters": "cm", "centimetre": "cm", "centimetres": "cm",
    "inch": "in", "inches": "in", '"': "in", "µm": "um", "μm": "um",
    "radian": "rad", "radians": "rad", "degree": "deg", "degrees": "deg", "°": "deg",
    "m_s": "m/s", "mm_s": "mm/s", "cm_s": "cm/s", "in_s": "in/s",
    "m_min": "m/min", "mm_min": "mm/min", "in_min": "in/min",
    "mps": "m/s", "mmps": "mm/s", "mm/sec": "mm/s", "m/sec": "m/s", "ipm": "in/min",
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "percent": "%",
}  # fmt: skip

_LARGEST_IN_METRES = 3.0
"""Coordinates up to here can be metres: hardly any arm reaches farther [m]."""
_SMALLEST_IN_MILLIMETRES = 30.0
"""Coordinates beyond this are no metres: ten times as far as an arm reaches."""


def unit_factor(unit: str, known: dict[str, float]) -> float | None:
    """Return the factor of a unit to SI; None: it is not one of those known."""
    word = unit.strip().lower().rstrip(".")
    return known.get(_WORDS.get(word, word))


def in_si(value: float, factor: float) -> float:
    """Return a value in SI; 565 mm are 0.565 m to the last digit, which 565 * 1e-3 is not."""
    inverse = 1.0 / factor
    return value / inverse if inverse.is_integer() else value * factor


def guess_length(values: Iterable[float]) -> tuple[float, Note]:
    """Tell the unit of coordinates from their size.

    Args:
        values: Every coordinate of the file.

    Returns:
        The factor to metres, and what to say of it.

    Raises:
        InvalidRequest: They can be metres and millimetres.
    """
    largest = max((abs(v) for v in values), default=0.0)
    if largest <= _LARGEST_IN_METRES:
        why = f"because no coordinate is beyond {_LARGEST_IN_METRES:g}: the largest is {largest:g}"
        return 1.0, Note(f"lengths read as metres, {why}", guessed=True)
    if largest >= _SMALLEST_IN_MILLIMETRES:
        why = f"because a coordinate of {largest:g} is beyond the reach of any arm in metres"
        return 1e-3, Note(f"lengths read as millimetres, {why}", guessed=True)
    raise InvalidRequest(
        f"the largest coordinate is {largest:g}, which can be metres or millimetres: give units "
        "(--units mm), or write the unit into the header as in 'x [mm]'",
        field="units",
        allowed=list(LENGTHS),
    )


def guess_angle(values: Iterable[float], what: str) -> tuple[float, Note]:
    """Tell the unit of angles from their size.

    Args:
        values: Every angle of the file.
        what: What they are, in words.

    Returns:
        The factor to radians, and what to say of it.

    Raises:
        InvalidRequest: They can be radians and degrees.
    """
    largest = max((abs(v) for v in values), default=0.0)
    if largest <= math.pi * (1.0 + 1e-4):
        why = f"because none is beyond pi: the largest is {largest:g}"
        return 1.0, Note(f"{what} read as radians, {why}", guessed=True)
    if largest > 2.0 * math.pi * (1.0 + 1e-4):
        why = f"because an angle of {largest:g} is beyond a full turn in radians"
        return ANGLES["deg"], Note(f"{what} read as degrees, {why}", guessed=True)
    raise InvalidRequest(
        f"the largest of the {what} is {largest:g}, which can be radians or degrees: give angles "
        "(--angles deg), or write the unit into the header as in 'roll [deg]'",
        field="angles",
        allowed=list(ANGLES),
    )
