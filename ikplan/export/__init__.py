"""Plans as files and bytes: one file a format, looked up by name, suffix or media type."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ikplan.errors import InvalidRequest
from ikplan.export import as_csv, as_json, as_npz, as_ros, as_urscript

if TYPE_CHECKING:
    from ikplan.export.formats import Format
    from ikplan.result import Plan

__all__ = ["FORMATS", "encode", "format_for", "format_named", "save"]

FORMATS: tuple[Format, ...] = (
    as_json.FORMAT,
    as_csv.FORMAT,
    as_npz.FORMAT,
    as_ros.FORMAT,
    as_urscript.FORMAT,
)
"""Every format; a new one is a module with a ``FORMAT`` and a line here."""


def format_for(path: str | Path) -> Format:
    """Return the format that a file's suffix names.

    Raises:
        InvalidRequest: No format has that suffix; lists those there are.
    """
    name = Path(path).name.lower()
    matches = [f for f in FORMATS for suffix in f.suffixes if name.endswith(suffix)]
    if not matches:
        suffixes = [suffix for f in FORMATS for suffix in f.suffixes]
        raise InvalidRequest(
            f"cannot tell a format from the file name {str(path)!r}; "
            f"name it with one of {', '.join(suffixes)}",
            field="output",
            allowed=suffixes,
        )
    return max(matches, key=lambda f: max(len(s) for s in f.suffixes if name.endswith(s)))


def format_named(name: str) -> Format:
    """Return the format of that name.

    Raises:
        InvalidRequest: No such format; lists those there are.
    """
    for known in FORMATS:
        if known.name == name:
            return known
    names = [f.name for f in FORMATS]
    raise InvalidRequest(
        f"no format named {name!r}; known formats: {', '.join(names)}",
        field="format",
        allowed=names,
    )


def encode(plan: Plan, name: str) -> bytes:
    """Return the bytes of a plan in the format of that name.

    Raises:
        InvalidRequest: No such format, or it cannot hold this plan.
    """
    return format_named(name).encode(plan)


def save(plan: Plan, path: str | Path, name: str | None = None) -> None:
    """Write a plan to a file.

    Args:
        plan: The plan.
        path: The file.
        name: Name of the format; None: the one that the file's suffix names.

    Raises:
        InvalidRequest: No such format, or it cannot hold this plan.
        OSError: The file cannot be written.
    """
    chosen = format_for(path) if name is None else format_named(name)
    Path(path).write_bytes(chosen.encode(plan))
