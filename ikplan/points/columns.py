"""Names of columns: what each holds, and in which unit."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ikplan.errors import InvalidRequest, near_names
from ikplan.points.conventions import ORIENTATIONS, POSITION
from ikplan.points.table import Row, fault
from ikplan.points.units import ANGLES, LENGTHS, SPEEDS, TIMES, unit_factor

__all__ = ["PASSED_OVER", "Column", "JointName", "name_columns"]

PASSED_OVER = ""
"""Role of a column that plays no part."""

_ORIENTED = tuple(name for o in ORIENTATIONS for name in o.columns)
_OTHERS = {
    "speed": "speed", "velocity": "speed", "vel": "speed", "v": "speed", "toolspeed": "speed",
    "tcpspeed": "speed", "feed": "feed", "feedrate": "feed", "f": "feed",
    "zone": "zone", "blend": "zone", "blendradius": "zone", "radius": "zone", "zonedata": "zone",
    "time": "time", "t": "time", "timestamp": "time", "stamp": "time", "timefromstart": "time",
    "id": PASSED_OVER, "no": PASSED_OVER, "nr": PASSED_OVER, "n": PASSED_OVER, "name": PASSED_OVER,
    "index": PASSED_OVER, "point": PASSED_OVER, "label": PASSED_OVER, "comment": PASSED_OVER,
    "#": PASSED_OVER, "-": PASSED_OVER, "_": PASSED_OVER, "": PASSED_OVER,
}  # fmt: skip
_SPELLINGS = {
    **{name: name for name in (*POSITION, *_ORIENTED)},
    **{f"{word}{c}": c for word in ("pos", "position", "p", "t", "tcp", "pt") for c in "xyz"},
    **{f"{c}{word}": c for word in ("pos", "position", "tcp") for c in "xyz"},
    **{
        f"{word}{c}": f"q{c}"
        for word in ("quat", "quaternion", "orientation", "ori", "rotation", "rot")
        for c in "xyzw"
        # rot x, without a w, is an angle of whoever wrote it
        if word not in ("rotation", "rot") or c == "w"
    },
    **{f"rotvec{c}": f"r{c}" for c in "xyz"},
    **{f"rotationvector{c}": f"r{c}" for c in "xyz"},
    **{f"toolaxis{c}": axis for c, axis in zip("xyz", "ijk", strict=True)},
    **_OTHERS,
}  # fmt: skip
_UNITS = {
    **dict.fromkeys(POSITION, LENGTHS),
    **{name: ANGLES for o in ORIENTATIONS if o.unit is not None for name in o.columns},
    "speed": {**SPEEDS, "%": 0.01},
    "feed": SPEEDS,
    "zone": LENGTHS,
    "time": TIMES,
    "joint": {**LENGTHS, **ANGLES},
    "counted joint": {**LENGTHS, **ANGLES},
}
_MOST_COLUMNS, _LONGEST_TITLE = 400, 200
_COUNTED, _IN_ORDER = "counted joint", -2
_BRACKETS = re.compile(r"(.*?)\s*[\[({]\s*([^\])}]*?)\s*[\])}]")
_SUFFIX = re.compile(r"(.+?)(?:\s+in\s+|[ _/.])([A-Za-z°\"µ%]+(?:[/_](?:s|sec|min))?)")
_NUMBERED = re.compile(r"(?:q|j|a|joint|axis|theta|jnt)[ _.]?(\d{1,2})")
_ABB = re.compile(r"q([1-4])")
_UNNAMED_ORIENTATION = re.compile(
    r"rot|ori|euler|quat|angle|alpha|beta|gamma|tilt|twist|normal|^n[ _.]?[xyz]$"
)
_RATES = re.compile(
    r"^(d+q|velocit|vel\b|acc|effort|torque|current)|(velocity|effort|acceleration)$"
)


@dataclass(frozen=True)
class JointName:
    """A joint of the robot that a file is for.

    Attributes:
        name: Its name.
        slides: Whether its values are lengths.
    """

    name: str
    slides: bool = False


@dataclass(frozen=True)
class Column:
    """A column of the file.

    Attributes:
        title: Its name as written.
        role: What it holds: a name of a position or an orientation, ``speed``, ``feed``,
            ``zone``, ``time``, ``joint``; or PASSED_OVER.
        unit: Its unit as written, or ``""``.
        factor: From its unit to SI; None: no unit is written.
        joint: Number of the joint from 0, as the robot or the names count them.
    """

    title: str
    role: str
    unit: str = ""
    factor: float | None = None
    joint: int = -1


def name_columns(header: Row, units: Row | None, joints: Sequence[JointName]) -> list[Column]:
    """Tell what the columns hold.

    Args:
        header: Their names.
        units: A line of units below; None: there is none.
        joints: The joints of the robot, where it is known.

    Raises:
        InvalidRequest: A unit is not known, or a name may mean several things.
    """
    if len(header.cells) > _MOST_COLUMNS:
        raise fault(header, f"{len(header.cells)} columns; at most {_MOST_COLUMNS} are read")
    if any(len(cell) > _LONGEST_TITLE for cell in header.cells):
        raise fault(header, f"a name of a column has more than {_LONGEST_TITLE} characters")
    below = units.cells if units is not None else []
    known = {joint.name.lower(): k for k, joint in enumerate(joints)}
    split = [_split(cell, known) for cell in header.cells]
    names = [name for name, _ in split]
    written = [unit or (below[k] if k < len(below) else "") for k, (_, unit) in enumerate(split)]
    posed = {"x", "y", "z"} <= {_SPELLINGS.get(_squeezed(n)) for n in names}
    columns = [
        _column(header, title, name, unit, known, posed)
        for title, name, unit in zip(header.cells, names, written, strict=True)
    ]
    columns = _numbered(header, _settled(columns), len(joints))
    for k, column in enumerate(columns):
        twin = next((c for c in columns[:k] if _key(c) == _key(column)), None)
        if column.role and twin is not None:
            raise fault(header, f"it holds the same as column {twin.title!r}", column=column.title)
    return columns


def _key(column: Column) -> tuple[str, int]:
    return column.role, column.joint


def _squeezed(name: str) -> str:
    return re.sub(r"[ _.\-/]", "", name.lower()) or name


def _split(cell: str, known: dict[str, int]) -> tuple[str, str]:
    """A title as name and unit."""
    if cell.lower().removeprefix("q ") in known:
        return cell, ""  # joint_1_s is a name, and no time in seconds
    if match := _BRACKETS.fullmatch(cell):
        return match[1].strip(), match[2]
    if match := _SUFFIX.fullmatch(cell):
        every = {**LENGTHS, **ANGLES, **SPEEDS, "%": 1.0, "ms": 1e-3, "s": 1.0}
        if unit_factor(match[2], every) is not None:
            return match[1], match[2]
    return cell, ""


def _column(
    header: Row, title: str, name: str, unit: str, known: dict[str, int], posed: bool
) -> Column:
    role, joint = _role(header, title, name, known, posed)
    if not role or not unit:
        return Column(title, role, joint=joint)
    units = _UNITS.get(role, {})
    factor = unit_factor(unit, units)
    if factor is None:
        valid = ", ".join(units) or "none"
        raise fault(header, f"unit {unit!r} is not known: {valid}", column=title, allowed=[*units])
    return Column(title, role, unit, factor, joint)


def _role(
    header: Row, title: str, name: str, known: dict[str, int], posed: bool
) -> tuple[str, int]:
    lowered = name.lower().strip()
    joint = _joint_of(lowered, known)
    if joint is not None:
        return "joint", joint
    if posed and (match := _ABB.fullmatch(lowered)):
        return f"q{'wxyz'[int(match[1]) - 1]}", -1  # ABB count the scalar part first
    if posed and lowered == "q0":
        return "q0", -1
    if _RATES.search(lowered) and lowered not in ("velocity", "vel"):
        return PASSED_OVER, -1
    role = _SPELLINGS.get(_squeezed(name.split("/")[-1]))
    if role is None:
        role = _SPELLINGS.get(_squeezed(".".join(re.split(r"[./]", name)[-2:])))
    if role is not None:
        return role, -1
    if match := _NUMBERED.fullmatch(lowered):
        return _COUNTED, int(match[1])
    if lowered.startswith("q "):  # as ikplan writes it
        if known:
            near = near_names(name[2:], known)
            hint = f"; did you mean {near[0]!r}?" if near else f": it has {', '.join(known)}"
            raise fault(header, f"the robot has no such joint{hint}", column=title)
        return _COUNTED, _IN_ORDER
    if posed and _UNNAMED_ORIENTATION.search(lowered):
        choices = [",".join(o.columns) for o in ORIENTATIONS]
        raise InvalidRequest(
            f"line {header.line}, column {title!r}: it seems to hold an orientation, but its name "
            "does not say in whose convention: name the columns (--columns), '-' for those to "
            f"pass over, with one of {'; '.join(choices)}",
            field="columns",
            allowed=choices,
        )
    return PASSED_OVER, -1


def _joint_of(name: str, known: dict[str, int]) -> int | None:
    """The joint that a column is named after, alone, as ``q NAME`` or as ``NAME/position``."""
    for spelling in (name, name.removeprefix("q "), re.split(r"[/.]", name)[0]):
        if spelling in known:
            rest = name.removeprefix("q ").removeprefix(spelling).strip("/. _")
            return known[spelling] if rest in ("", "pos", "position") else None
    parts = re.split(r"[/.]", name)
    if len(parts) > 1 and parts[-1] in ("pos", "position") and parts[-2] in known:
        return known[parts[-2]]
    for ending in ("_pos", "_position", " position"):
        if name.removesuffix(ending) in known:
            return known[name.removesuffix(ending)]
    return None


def _settled(columns: list[Column]) -> list[Column]:
    """The columns, names settled that depend on others: q0 first, w of a quaternion."""
    roles = {c.role for c in columns}
    renamed: dict[str, str] = {}
    if "q0" in roles:
        # q0, q1, q2, q3: read as q1 to q4 above, one too far.
        renamed = {"q0": "qw", "qw": "qx", "qx": "qy", "qy": "qz"}
    elif {"qx", "qy", "qz"} <= roles and "w" in roles and not roles & {"p", "r"}:
        renamed = {"w": "qw"}
    return [
        Column(c.title, renamed.get(c.role, c.role), c.unit, c.factor, c.joint) for c in columns
    ]


def _numbered(header: Row, columns: list[Column], dof: int) -> list[Column]:
    """The columns, joints that the file counts itself as numbers from 0."""
    counted = [c for c in columns if c.role == _COUNTED]
    if not counted:
        return columns
    numbers = [c.joint for c in counted]
    if set(numbers) == {_IN_ORDER}:
        numbers = list(range(len(counted)))
    first = min(numbers)
    if dof and len(counted) < dof and any(c.role == "joint" for c in columns):
        return [Column(c.title, PASSED_OVER) if c in counted else c for c in columns]
    if sorted(numbers) != [*range(first, first + len(numbers))] or first not in (0, 1):
        titles = ", ".join(c.title for c in counted)
        raise fault(header, f"the joints {titles} do not count from 0 or 1 without a gap")
    places = iter(number - first for number in numbers)
    return [
        Column(c.title, "joint", c.unit, c.factor, next(places)) if c in counted else c
        for c in columns
    ]
