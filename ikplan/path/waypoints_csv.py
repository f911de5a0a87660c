"""Waypoints read from CSV."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ikplan.documents.path import MAX_WAYPOINTS
from ikplan.documents.poses import unit_quaternion
from ikplan.errors import InvalidRequest, near_names
from ikplan.path.rotation import quaternion_of, rotation_of

__all__ = ["read_waypoints_csv"]

_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
_ANGLES = {"rad": 1.0, "deg": math.pi / 180.0}
_POSITION = ("x", "y", "z")
_QUATERNION = ("qx", "qy", "qz", "qw")
_RPY = ("roll", "pitch", "yaw")
_COLUMN = re.compile(r"\s*([A-Za-z]+)\s*(?:[\[(]\s*([A-Za-z]*)\s*[\])]|_([A-Za-z]+))?\s*")


def read_waypoints_csv(source: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """Read waypoints from a CSV file or from its text.

    The first line names the columns, in any order: ``x, y, z`` and, if there is an orientation,
    ``qx, qy, qz, qw`` (a unit quaternion) or ``roll, pitch, yaw`` (turns about the fixed axes x, y
    and z, in this order). A unit may follow a name, as in ``x [mm]`` or ``yaw_deg``: m, mm, cm or
    in; rad or deg. Without one it is metres and radians. Values are separated by commas,
    semicolons or tabs. Lines that are empty or begin with ``#`` are passed over. A row whose
    cells of orientation are all empty is a waypoint without orientation.

    Args:
        source: A path, or the text itself: a string with a line break.

    Returns:
        Waypoints as the request has them, in order.

    Raises:
        InvalidRequest: The text is no such table; names the line, or the file.
    """
    lines = _lines(source)
    number, header = next(lines, (1, ""))
    separator = next((c for c in ";\t" if c in header), ",")
    scales = _columns(number, _cells(header, separator))
    waypoints = []
    for number, text in lines:
        cells = _cells(text, separator)
        if len(cells) != len(scales):
            raise _fault(number, f"{len(cells)} values for {len(scales)} columns")
        waypoints.append(_waypoint(number, dict(zip(scales, cells, strict=True)), scales))
        if len(waypoints) > MAX_WAYPOINTS:
            raise _fault(number, f"more than {MAX_WAYPOINTS} waypoints")
    if not waypoints:
        raise _fault(number, "no waypoint follows the names of the columns")
    return waypoints


def _lines(source: str | os.PathLike[str]) -> Iterator[tuple[int, str]]:
    """The lines that count, with their numbers from 1."""
    if isinstance(source, str) and "\n" in source:
        text = source
    else:
        try:
            text = Path(source).read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise InvalidRequest(
                f"{os.fspath(source)!r} cannot be read as CSV text: {error}", allowed="a CSV file"
            ) from error
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), start=1):
        if line.strip(" \t,;") and not line.lstrip().startswith("#"):
            yield number, line


def _cells(line: str, separator: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]


def _fault(line: int, detail: str, allowed: Any = None) -> InvalidRequest:
    return InvalidRequest(f"line {line}: {detail}", field=f"line {line}", allowed=allowed)


def _columns(line: int, cells: list[str]) -> dict[str, float]:
    """Names of the columns in order, each with the factor to SI units."""
    known = (*_POSITION, *_QUATERNION, *_RPY)
    scales: dict[str, float] = {}
    for cell in cells:
        match = _COLUMN.fullmatch(cell)
        name = match[1].lower() if match else cell
        if match is None or name not in known:
            near = near_names(name, known)
            hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"
            raise _fault(line, f"unknown column {cell!r}; {hint}", list(known))
        if name in scales:
            raise _fault(line, f"column {name!r} is there twice")
        units = _LENGTHS if name in _POSITION else _ANGLES if name in _RPY else {}
        unit = match[2] or match[3]
        if unit and unit not in units:
            valid = ", ".join(units) or "none"
            raise _fault(
                line, f"unit {unit!r} of column {name!r} is not known: {valid}", list(units)
            )
        scales[name] = units[unit] if unit else 1.0
    given = set(scales)
    if given not in (set(_POSITION), {*_POSITION, *_QUATERNION}, {*_POSITION, *_RPY}):
        raise _fault(
            line,
            f"the columns {', '.join(scales)} make no pose",
            "x, y, z; with qx, qy, qz, qw or roll, pitch, yaw or neither",
        )
    return scales


def _waypoint(line: int, row: dict[str, str], scales: dict[str, float]) -> dict[str, Any]:
    orientation = [row[name] for name in (*_QUATERNION, *_RPY) if name in row]
    without = not any(orientation)
    values = {
        name: _number(line, name, cell) * scales[name]
        for name, cell in row.items()
        if name in _POSITION or not without
    }
    waypoint: dict[str, Any] = {"position": [values[name] for name in _POSITION]}
    if "qw" in values:
        try:
            waypoint["quaternion_xyzw"] = unit_quaternion([values[name] for name in _QUATERNION])
        except ValueError as error:
            raise _fault(line, str(error)) from error
    elif "yaw" in values:
        waypoint["quaternion_xyzw"] = _quaternion_of_rpy(*(values[name] for name in _RPY))
    return waypoint


def _number(line: int, name: str, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _fault(line, f"{cell!r} in column {name!r} is not a finite number", "a number")
    return value


def _quaternion_of_rpy(roll: float, pitch: float, yaw: float) -> list[float]:
    R = rotation_of([0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)])
    R = R @ rotation_of([0.0, math.sin(0.5 * pitch), 0.0, math.cos(0.5 * pitch)])
    R = R @ rotation_of([math.sin(0.5 * roll), 0.0, 0.0, math.cos(0.5 * roll)])
    return [float(c) for c in quaternion_of(R)]
