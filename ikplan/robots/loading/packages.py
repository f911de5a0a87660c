"""Packages of a folder tree: a name, and the folder that ``$(find name)`` and ``package://`` mean.

No ROS is needed. A package is a folder with a ``package.xml`` that says its name; those near a file
are found by walking up from it and looking below each folder on the way. A folder that has the name
and no such file counts too: data sets often leave it out, and ``_support`` or ``_description`` at
the end of its name with it.
"""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Iterator
from pathlib import Path

from ikplan.errors import InvalidRobot, near_names

__all__ = ["find_package", "package_root"]

_FILE = "package.xml"
_NAME = re.compile(rb"<name>\s*([^<\s]+)\s*</name>")
_UP, _DOWN = 6, 4
"""Folders that are looked at above a file, and below each of these."""
_MOST_FOLDERS = 4_000
"""Folders that are looked at in all."""


def package_root(file: Path) -> Path | None:
    """Return the folder of the package that a file belongs to, or None where there is none."""
    for folder in list(file.resolve().parents)[: _UP + 1]:
        if (folder / _FILE).is_file():
            return folder
    return None


def find_package(name: str, file: Path) -> Path:
    """Return the folder of a package that a file names.

    Args:
        name: Name of the package.
        file: The file, for where to look.

    Raises:
        InvalidRobot: There is no such package near; those that there are are listed.
    """
    resolved = file.resolve()
    near = _packages_near(resolved.parent)
    if name in near:
        return near[name]
    above = list(resolved.parents)[: _UP + 1]
    for folder in above:
        if folder.name == name:
            return folder
        if (folder / name).is_dir():
            return folder / name
    for folder in above[:-1]:  # a folder whose package.xml and last word were left out
        for place in (folder, *(f for f in sorted(folder.iterdir()) if f.is_dir())):
            if _plain(place.name) == _plain(name) and place not in near.values():
                return place
    hint = near_names(name, near)
    known = ", ".join(sorted(near)[:40]) or "none"
    raise InvalidRobot(
        f"{file.name}: no package {name!r} near it"
        + (f"; did you mean {hint[0]}?" if hint else "")
        + f"; put its folder beside that of the file. Packages found: {known}",
        robot=file.name,
        value=name,
        valid=sorted(near),
    )


def _plain(name: str) -> str:
    return name.removesuffix("_description").removesuffix("_support")


@functools.lru_cache(maxsize=64)
def _packages_near(start: Path) -> dict[str, Path]:
    """Packages above and around a folder; of two of a name, the nearer one."""
    found: dict[str, Path] = {}
    seen: set[Path] = set()
    places = [start, *start.parents][: _UP + 1]
    left = _MOST_FOLDERS
    for place in places:
        if len(place.parts) <= 2:  # / and what holds homes: nobody's packages alone
            break
        for folder in _folders(place, _DOWN, seen):
            left -= 1
            if left < 0:
                return found
            if (folder / _FILE).is_file():
                match = _NAME.search((folder / _FILE).read_bytes()[:20_000])
                if match:
                    found.setdefault(match[1].decode(errors="replace"), folder)
    return found


def _folders(top: Path, depth: int, seen: set[Path]) -> Iterator[Path]:
    """A folder and those below it, nearest first, in order of their names; none twice."""
    level = [top]
    for _ in range(depth + 1):
        below: list[Path] = []
        for folder in level:
            if folder not in seen:
                seen.add(folder)
                yield folder
            try:
                entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
            except OSError:
                continue
            below += [
                Path(entry.path)
                for entry in entries
                if entry.is_dir(follow_symlinks=False) and not entry.name.startswith(".")
            ]
        level = below
