"""The poses of a file: positions in one unit, orientations in one convention."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ikplan.documents.base import MAX_NUMBER
from ikplan.documents.poses import unit_quaternion
from ikplan.errors import InvalidRequest
from ikplan.points.conventions import (
    AXIS,
    ORIENTATIONS,
    POSITION,
    QUATERNION,
    ROTATION_VECTOR,
    Orientation,
)
from ikplan.points.note import Note
from ikplan.points.points import Points
from ikplan.points.rotations import axis_quaternion
from ikplan.points.table import Row, fault
from ikplan.points.units import ANGLES, LENGTHS, guess_angle, guess_length, in_si
from ikplan.points.values import Values

__all__ = ["one_factor", "read_poses"]

_AXIS_SLACK = 1e-2
"""How far the length of a tool axis may be from 1: it is written with few digits."""


def read_poses(
    values: Values, units: str | None, angles: str | None, free_axis: str | None
) -> tuple[Points, float]:
    """Return the poses of a file.

    Args:
        values: Its numbers.
        units: Unit of lengths that the caller gives, or None.
        angles: Unit of angles that the caller gives, or None.
        free_axis: Axis of the tool about which it may turn, or None.

    Returns:
        The points, and the factor of lengths to metres.

    Raises:
        InvalidRequest: A value is wrong, or its unit is open.
    """
    places = [_place(values, name) for name in POSITION]
    scale, notes = one_factor(
        values, places, "units", units, LENGTHS, lambda: guess_length(values.numbers(places))
    )
    orientation = next((o for o in ORIENTATIONS if values.place(o.columns[0]) is not None), None)
    turned = _Turned.none() if orientation is None else _turned(values, orientation, angles)
    notes += turned.notes
    if orientation is AXIS:
        free_axis = free_axis or "z"
        notes.append(Note(_axis_words(values, turned.places, free_axis)))
    elif orientation is None and free_axis is not None:
        raise InvalidRequest(
            "free_axis: without an orientation in the file every axis is free", field="free_axis"
        )
    before: list[float] | None = None
    poses = []
    for row in values.rows:
        numbers = [values.number(row, k) for k in places]
        position = [in_si(v, scale) for v in numbers]
        if max(map(abs, position)) > MAX_NUMBER:
            raise fault(row, f"a coordinate is beyond {MAX_NUMBER:g} m")
        pose: dict[str, Any] = {"position": position}
        if orientation is not None and not values.is_empty(row, turned.places):
            before = _quaternion(values, row, orientation, turned, free_axis, before)
            pose["quaternion_xyzw"] = before
        poses.append(pose)
    axis = None if free_axis is None else f"tool_{free_axis[-1]}"
    return Points(poses=poses, free_axis=axis, notes=notes), scale


def _place(values: Values, name: str) -> int:
    place = values.place(name)
    assert place is not None  # as the header was checked for
    return place


def one_factor(
    values: Values,
    places: Sequence[int],
    option: str,
    told: str | None,
    known: dict[str, float],
    guess: Any,
) -> tuple[float, list[Note]]:
    """Return the one factor to SI of some columns: as written, as the caller says, or guessed.

    Args:
        values: The numbers.
        places: The columns.
        option: Name of the caller's option.
        told: Its value, or None.
        known: Factors by unit.
        guess: Returns a factor and a note, where neither the file nor the caller says it.

    Raises:
        InvalidRequest: Columns differ, or the header and the caller do.
    """
    columns = [values.columns[k] for k in places]
    written = {c.factor: c for c in columns if c.factor is not None}
    if len(written) > 1:
        words = " and ".join(f"{c.title!r}" for c in written.values())
        raise InvalidRequest(
            f"the columns {words} have different units", field=option, allowed=list(known)
        )
    for factor, column in written.items():
        if told is not None and known[told] != factor:
            raise InvalidRequest(
                f"{option}: {told} is given, but the header says {column.title!r}", field=option
            )
        return factor, []
    if told is not None:
        return known[told], []
    factor, note = guess()
    return factor, [note]


@dataclass(frozen=True)
class _Turned:
    """The columns of an orientation: where they are, their factor to radians, what to say."""

    places: list[int]
    scale: float
    notes: list[Note]

    @classmethod
    def none(cls) -> _Turned:
        return cls([], 1.0, [])


def _turned(values: Values, orientation: Orientation, angles: str | None) -> _Turned:
    places = [_place(values, name) for name in orientation.columns]
    titles = ", ".join(values.columns[k].title for k in places)
    words = f"{titles} read as {orientation.words}"
    if orientation is AXIS:
        return _Turned(places, 1.0, [])
    if orientation.unit is None:
        if places[3] < places[0]:
            words += " with the scalar part first"
        return _Turned(places, 1.0, [Note(words)])
    numbers = values.numbers(places)
    if orientation is ROTATION_VECTOR:
        _check_rotation_vector(values, places, numbers, angles)

    def otherwise() -> tuple[float, Note]:
        if not orientation.unit:
            return guess_angle(numbers, f"angles {titles}")
        by = f"in {orientation.unit}"
        return ANGLES[orientation.unit], Note(f"{titles}: {by}, as is usual for them")

    scale, notes = one_factor(values, places, "angles", angles, ANGLES, otherwise)
    return _Turned(places, scale, [Note(words), *notes])


def _check_rotation_vector(
    values: Values, places: Sequence[int], numbers: Sequence[float], angles: str | None
) -> None:
    """In degrees, rx, ry, rz are the angles of other makers more often than a vector."""
    written = {values.columns[k].factor for k in places}
    longest = max((math.hypot(*numbers[k : k + 3]) for k in range(0, len(numbers), 3)), default=0.0)
    in_degrees = ANGLES["deg"] in written or (written == {None} and longest > 2.0 * math.pi + 1e-3)
    if angles is None and in_degrees:
        raise InvalidRequest(
            "rx, ry, rz in degrees can be a rotation vector (then give angles: --angles deg) or "
            "turns about fixed axes (then name the columns: --columns x,y,z,roll,pitch,yaw)",
            field="angles",
            allowed=["angles=deg", "columns=x,y,z,roll,pitch,yaw"],
        )


def _quaternion(
    values: Values,
    row: Row,
    orientation: Orientation,
    turned: _Turned,
    free_axis: str | None,
    before: list[float] | None,
) -> list[float]:
    numbers = [in_si(values.number(row, k), turned.scale) for k in turned.places]
    titles = ", ".join(values.columns[k].title for k in turned.places)
    if orientation is AXIS:
        length = math.hypot(*numbers)
        if abs(length - 1.0) > _AXIS_SLACK:
            raise fault(row, f"a tool axis has length 1, not {length:.6g}", column=titles)
        return axis_quaternion(free_axis or "z", [v / length for v in numbers], before)
    assert orientation.build is not None
    quaternion = orientation.build(numbers)
    if orientation is QUATERNION:
        norm = math.hypot(*quaternion)
        if abs(norm - 1.0) > 1e-3:
            raise fault(row, f"a quaternion has norm 1, not {norm:.6g}", column=titles)
    return unit_quaternion(quaternion) or quaternion


def _axis_words(values: Values, places: Sequence[int], axis: str) -> str:
    against = "against" if axis.startswith("-") else "along"
    words = f"i, j, k read as a direction that the tool's {axis[-1]} points {against}"
    numbers = values.numbers([places[2]])
    if axis == "z" and numbers and min(numbers) > 0.0:
        words += (
            "; all point up: if they lead from the tip to the spindle, as in APT, give "
            "--free-axis=-z"
        )
    return f"{words}; the turn about it is free"
