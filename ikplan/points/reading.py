"""Reading points from CSV: see docs/points.md for what is understood."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ikplan.documents.path import MAX_WAYPOINTS
from ikplan.errors import InvalidRequest, near_names
from ikplan.points.columns import PASSED_OVER, JointName, name_columns
from ikplan.points.conventions import ORIENTATIONS, POSITION
from ikplan.points.extras import read_speeds, read_zones
from ikplan.points.joints import read_joints
from ikplan.points.names import TOOL_AXES
from ikplan.points.note import Note
from ikplan.points.points import Points
from ikplan.points.poses import read_poses
from ikplan.points.table import Row, Table, fault, is_number, read_table
from ikplan.points.units import ANGLES, LENGTHS
from ikplan.points.values import Values

__all__ = ["Reading", "read_points", "read_waypoints"]

MAX_JOINT_ROWS = 20_000
"""Rows of joint values, as many as a timing takes."""

_log = logging.getLogger("ikplan.points")


@dataclass(frozen=True)
class Reading:
    """What the file itself does not say.

    Attributes:
        units: Unit of lengths: m, mm, cm, um or in; None: as the header says, else guessed.
        angles: Unit of angles: rad or deg; None: as the header or the convention says, else
            guessed.
        columns: Names of the columns in order, separated by commas, instead of a header; ``-``
            for one to pass over.
        free_axis: Axis of the tool about which it may turn, x, y or z; the one that columns i, j,
            k give the direction of, with a minus (``-z``) for the opposite direction. None: z for
            i, j, k, else none.

    Raises:
        InvalidRequest: An option has none of the values allowed.
    """

    units: str | None = None
    angles: str | None = None
    columns: str | None = None
    free_axis: str | None = None

    def __post_init__(self) -> None:
        allowed = {"units": LENGTHS, "angles": ANGLES, "free_axis": TOOL_AXES}
        for name, choices in allowed.items():
            value = getattr(self, name)
            if value is not None and value not in choices:
                raise InvalidRequest(
                    f"{name}: {', '.join(choices)} are allowed, not {value!r}",
                    field=name,
                    allowed=list(choices),
                )


def read_waypoints(
    path: str | os.PathLike[str],
    *,
    units: str | None = None,
    angles: str | None = None,
    columns: str | None = None,
) -> list[dict[str, Any]]:
    """Read the poses of a CSV file.

    How the file was read goes to the logger ``ikplan.points``: what was guessed as a warning.
    Columns of speeds, zones and times are checked and left out; :func:`ikplan.points.read_points`
    has them.

    Args:
        path: The file.
        units: Unit of lengths, see :class:`Reading`.
        angles: Unit of angles.
        columns: Names of the columns, for a file without a header.

    Returns:
        Waypoints as the request has them, in order [m; unit quaternions x, y, z, w]. Where the file
        gives a tool axis, the tool's z points along it and the turn about it is any.

    Raises:
        InvalidRequest: The file is no such table; names line and column.
    """
    points = read_points(path, Reading(units, angles, columns))
    if not points.poses:
        raise InvalidRequest(
            f"{os.fspath(path)} has joint values and no poses", allowed="columns x, y, z"
        )
    for note in points.notes:
        _log.log(logging.WARNING if note.guessed else logging.INFO, "%s", note.text)
    return points.poses


def read_points(
    source: str | os.PathLike[str] | bytes,
    reading: Reading | None = None,
    joints: Sequence[JointName] = (),
) -> Points:
    """Read poses or joint values from CSV.

    Args:
        source: A file, or its bytes.
        reading: What the file itself does not say.
        joints: The joints of the robot, where it is known: columns may have their names.

    Returns:
        The points.

    Raises:
        InvalidRequest: The file is no such table, or may be read in several ways; names line and
            column, or the option that settles it.
    """
    reading = reading or Reading()
    table = read_table(source if isinstance(source, bytes) else _bytes_of(source))
    header, units, rows, notes = _header_of(table, reading, joints)
    columns = name_columns(header, units, joints)
    if not rows:
        raise fault(header, "no point follows the names of the columns")
    roles = {column.role for column in columns}
    most = MAX_JOINT_ROWS if "joint" in roles else MAX_WAYPOINTS
    if len(rows) > most:
        raise fault(rows[most], f"more than {most} points")
    values = Values(Table(header, rows, table.separator, []), columns)
    if "joint" in roles and roles & set(POSITION):
        titles = ", ".join(c.title for c in columns if c.role == "joint")
        raise fault(
            header,
            f"there are positions and joint values ({titles}): name the columns (--columns), '-' "
            "for those to pass over",
        )
    if "joint" in roles:
        points = read_joints(values, header, reading.units, reading.angles, joints)
        factor = 1.0
    else:
        _check_poses(header, [c.title for c in columns], roles)
        points, factor = read_poses(values, reading.units, reading.angles, reading.free_axis)
    notes = [*notes, *points.notes]
    passed = [c.title for c in columns if c.role == PASSED_OVER and c.title not in ("", "-", "_")]
    if passed:
        notes.append(Note(f"passed over: {', '.join(passed)}"))
    return Points(
        poses=points.poses,
        joints=points.joints,
        speeds=read_speeds(values, factor),
        zones=read_zones(values, factor),
        timed="time" in roles,
        free_axis=points.free_axis,
        notes=notes,
    )


def _bytes_of(path: str | os.PathLike[str]) -> bytes:
    try:
        return Path(path).read_bytes()
    except (OSError, ValueError) as error:
        raise InvalidRequest(
            f"{os.fspath(path)!r} cannot be read: {error}", allowed="a CSV file"
        ) from error


def _names_points(comment: Row, joints: Sequence[JointName]) -> bool:
    """Whether a comment names the columns of poses, or of joint values."""
    try:
        roles = {column.role for column in name_columns(comment, None, joints)}
    except InvalidRequest:
        return False
    return set(POSITION) <= roles or roles == {"joint"}


def _header_of(
    table: Table, reading: Reading, joints: Sequence[JointName]
) -> tuple[Row, Row | None, list[Row], list[Note]]:
    """The names of the columns, their units, the rows of data, and what to say."""
    rows, units = table.rows, None
    if table.header is not None and rows and not any(is_number(c) for c in rows[0].cells):
        units, rows = rows[0], rows[1:]
    if reading.columns is not None:
        line = table.header.line if table.header else 0
        return Row(line, [name.strip() for name in reading.columns.split(",")]), units, rows, []
    if table.header is not None:
        return table.header, units, rows, []
    width = len(rows[0].cells)
    for comment in table.comments:
        if len(comment.cells) == width and _names_points(comment, joints):
            note = Note(f"columns named by the comment on line {comment.line}", guessed=True)
            return comment, None, rows, [note]
    if width == 3:
        note = Note("no header: the three columns read as x, y, z", guessed=True)
        return Row(rows[0].line, ["x", "y", "z"]), None, rows, [note]
    choices = [
        ",".join((*POSITION, *o.columns)) for o in ORIENTATIONS if len(o.columns) + 3 == width
    ]
    if width == 7:
        choices.append("x,y,z,qw,qx,qy,qz")
    example = f", such as {' or '.join(choices)}" if choices else ""
    raise InvalidRequest(
        f"line {rows[0].line}: there is no header, and {width} columns can be several things: name "
        f"them (--columns){example}",
        field="columns",
        allowed=choices or None,
    )


def _check_poses(header: Row, columns_of: list[str], roles: set[str]) -> None:
    missing = [name for name in POSITION if name not in roles]
    titles = ", ".join(columns_of)
    if missing:
        near = [n for c in columns_of for n in near_names(c, missing)]
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise fault(
            header,
            f"the columns {titles} make no points: {', '.join(missing)} is missing{hint}; "
            "known are x, y, z, an orientation, or joint values under the names of the robot's "
            "joints or as j1, j2, ...",
            allowed="x, y, z or joints",
        )
    begun = [o for o in ORIENTATIONS if roles & set(o.columns)]
    if len(begun) > 1:
        several = " and ".join(", ".join(c for c in o.columns if c in roles) for o in begun)
        raise fault(
            header,
            f"there are two orientations, {several}: name the columns (--columns), '-' for those "
            "to pass over",
        )
    for orientation in begun:
        lacking = [name for name in orientation.columns if name not in roles]
        if lacking:
            near = [c for c in columns_of for n in near_names(c, lacking)]
            hint = f"; is column {near[0]!r} meant for it?" if near else ""
            raise fault(
                header,
                f"the columns {titles} make no pose: {', '.join(lacking)} is missing of "
                f"{', '.join(orientation.columns)}{hint}",
                allowed=list(orientation.columns),
            )
