"""A temporary copy of what the tests need, in which the mutants are made."""

from __future__ import annotations

import shutil
from pathlib import Path

__all__ = ["ROOT", "Room"]

ROOT = Path(__file__).resolve().parents[2]
"""The checkout."""

_PARTS = ("ikplan", "api", "robots", "tests", "benchmarks", "examples", "docs")
_FILES = ("pyproject.toml", "README.md")


class Room:
    """A copy of the checkout; the checkout itself is never written to.

    Args:
        folder: An empty folder.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for part in _PARTS:
            shutil.copytree(
                ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__")
            )
        for file in _FILES:
            shutil.copy(ROOT / file, folder / file)

    def source(self, file: str) -> str:
        """Return the text of a module of the package as it is in the checkout."""
        return (ROOT / "ikplan" / file).read_text()

    def write(self, file: str, source: str) -> None:
        """Write a module of the package.

        What was compiled of the one before goes: Python tells two versions of a module by their
        length and by the second they were written in.
        """
        path = self.folder / "ikplan" / file
        path.write_text(source)
        for compiled in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
            compiled.unlink()
