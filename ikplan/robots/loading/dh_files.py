"""DH tables in files of their own: YAML or CSV, one row a joint.

Columns (fields) are ``a``, ``d``, ``alpha``, ``theta`` (the offset of a turning joint, the fixed
angle of a sliding one), and as far as known ``name``, ``type``, ``lower``, ``upper``, ``velocity``,
``acceleration``, ``effort``. The convention has to be said: tables of both kinds look the same.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, cast

from pydantic import ValidationError

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.chains import dh_tree
from ikplan.robots.definition.schema import DhKinematics, DhRow, JointEntry
from ikplan.robots.urdf.tree import KinematicTree
from ikplan.robots.yaml_text import load_yaml

__all__ = ["is_dh_document", "read_dh_file"]

_SETTINGS = {
    "convention": ("standard", "modified"),
    "angles": ("rad", "deg"),
    "lengths": ("m", "mm"),
}
_LENGTHS, _ANGLES = ("a", "d"), ("alpha", "theta")
_LIMITS = ("lower", "upper", "velocity", "acceleration", "effort")
_OTHER_NAMES = {"theta_offset": "theta", "offset": "theta", "joint": "name"}
_COLUMNS = ("name", "type", *_LENGTHS, *_ANGLES, *_LIMITS)


def is_dh_document(content: Any) -> bool:
    """Whether a YAML document is a DH table, not a ``robot.yaml``."""
    return isinstance(content, dict) and "rows" in content


def read_dh_file(
    path: Path, document: bytes, arguments: Mapping[str, str], *, robot: str
) -> tuple[KinematicTree, list[JointEntry]]:
    """Read a DH table.

    Args:
        path: The file, for its suffix: ``.csv``, or YAML with the fields ``rows`` and settings.
        document: Its content.
        arguments: Settings that replace the file's: ``convention``, ``angles``, ``lengths``.
        robot: Name of the robot.

    Returns:
        The chain from ``base`` to ``tool``, and the limits of its joints [rad or m].

    Raises:
        InvalidRobot: A setting or a number is missing or makes no sense; it is named.
    """
    try:
        text = document.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InvalidRobot(f"{robot}: not UTF-8 text: {error}", robot=robot) from error
    if path.suffix.lower() == ".csv":
        rows, said = _csv_rows(text, robot)
    else:
        content = load_yaml(text)
        rows, said = content["rows"], {k: v for k, v in content.items() if k != "rows"}
    settings = _settings({**said, **arguments}, robot)
    if not isinstance(rows, list) or not 1 <= len(rows) <= 64:
        raise InvalidRobot(f"{robot}: DH table: must have 1 to 64 rows", robot=robot)
    table, entries, kinds = [], [], []
    for i, row in enumerate(rows):
        read = _row(row, i, settings, robot)
        slides = read["type"] == "prismatic"
        table.append(
            DhRow(
                a=read["a"], d=read["d"], alpha=read["alpha"], theta_offset=read.get("theta", 0.0)
            )
        )
        kinds.append("prismatic" if slides else str(read["type"]))
        entries.append(
            JointEntry(name=str(read["name"]), **{key: read[key] for key in _LIMITS if key in read})
        )
    convention = cast(Literal["standard", "modified"], settings["convention"])
    names = [entry.name for entry in entries]
    tree = dh_tree(
        robot,
        DhKinematics(convention=convention, rows=table),
        names,
        base="base",
        tip="tool",
        radians=1.0,
        kinds=kinds,
    )
    return tree, entries


def _settings(said: Mapping[str, Any], robot: str) -> dict[str, str]:
    settings = {"angles": "rad", "lengths": "m"}
    for key, value in said.items():
        if key in ("name", "title"):
            continue
        if key not in _SETTINGS or value not in _SETTINGS[key]:
            choices = _SETTINGS.get(key)
            raise InvalidRobot(
                f"{robot}: DH table: {key}: {value!r} is not one of {', '.join(choices)}"
                if choices
                else f"{robot}: DH table: no setting {key!r}; there are {', '.join(_SETTINGS)}",
                robot=robot,
                value=key,
                valid=list(choices or _SETTINGS),
            )
        settings[key] = str(value)
    if "convention" not in settings:
        raise InvalidRobot(
            f"{robot}: DH table: say which convention it has: convention: standard (frame i at the "
            "end of link i) or modified (Craig; alpha and a of i - 1); on a command line, "
            "convention:=standard",
            robot=robot,
            value="convention",
            valid=_SETTINGS["convention"],
        )
    return settings


def _csv_rows(text: str, robot: str) -> tuple[list[dict[str, str]], dict[str, str]]:
    """Rows by column, and settings from comments such as ``# convention: modified``."""
    said, lines = {}, []
    for line in text.splitlines():
        if line.lstrip().startswith("#"):
            match = re.fullmatch(r"\s*#\s*(\w+)\s*[:=]\s*(\w+)\s*", line)
            if match and match[1] in _SETTINGS:
                said[match[1]] = match[2]
        elif line.strip():
            lines.append(line)
    reader = csv.DictReader(io.StringIO("\n".join(lines)), skipinitialspace=True)
    try:
        rows = [{k.strip(): (v or "").strip() for k, v in row.items() if k} for row in reader]
    except (csv.Error, AttributeError) as error:
        raise InvalidRobot(f"{robot}: DH table: not CSV: {error}", robot=robot) from error
    return rows, said


def _row(row: Any, i: int, settings: Mapping[str, str], robot: str) -> dict[str, Any]:
    where = f"{robot}: DH table: row {i + 1}"
    if not isinstance(row, dict):
        raise InvalidRobot(f"{where}: must have fields by name", robot=robot)
    read: dict[str, Any] = {"name": f"joint_{i + 1}", "type": "revolute"}
    said = {_OTHER_NAMES.get(k, k): v for k, v in row.items() if v not in (None, "")}
    for key, value in said.items():
        if key not in _COLUMNS:
            raise InvalidRobot(
                f"{where}: no column {key!r}; there are {', '.join(_COLUMNS)}",
                robot=robot,
                value=key,
                valid=_COLUMNS,
            )
        read[key] = value if key in ("name", "type") else _number(value, f"{where}: {key}", robot)
    if read["type"] not in ("revolute", "continuous", "prismatic"):
        raise InvalidRobot(f"{where}: type: {read['type']!r} is not one of revolute, continuous, "
                           "prismatic", robot=robot, value=read["type"])  # fmt: skip
    slides = read["type"] == "prismatic"
    needed = ("a", "alpha", "theta" if slides else "d")
    missing = [key for key in needed if key not in read]
    if missing:
        raise InvalidRobot(f"{where}: {missing[0]} is missing", robot=robot, value=missing[0])
    read.setdefault("d", 0.0)
    angle = math.radians(1.0) if settings["angles"] == "deg" else 1.0
    length = 1e-3 if settings["lengths"] == "mm" else 1.0
    for keys, unit in (
        (_LENGTHS, length),
        (_ANGLES, angle),
        (_LIMITS[:-1], length if slides else angle),
    ):
        for key in keys:
            if key in read:
                read[key] *= unit
    return read


def _number(value: Any, what: str, robot: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, ValidationError) as error:
        raise InvalidRobot(f"{what} is not a number: {value!r}", robot=robot) from error
    if not math.isfinite(number):
        raise InvalidRobot(f"{what} is {value}; it must be finite", robot=robot)
    return number
