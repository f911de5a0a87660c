"""The data of this folder: named mutants, the tests of each module, equivalent mutants."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.mutants.mutant import Mutant

__all__ = ["Equivalent", "Module", "equivalents", "modules", "named_mutants"]

_HERE = Path(__file__).parent


@dataclass(frozen=True)
class Module:
    """What is planned for a module.

    Attributes:
        file: The module, relative to the package.
        room: The part of the package that its mutants are counted in.
        drawn: Whether mutants are drawn from it, besides those that have names.
        tests: Test files or node ids, most telling first.
    """

    file: str
    room: str
    drawn: bool
    tests: tuple[str, ...]


@dataclass(frozen=True)
class Equivalent:
    """A mutant that no test can find.

    Attributes:
        file: The module, relative to the package.
        old: The lines replaced, stripped, joined by spaces.
        new: The lines that replace them.
        reason: Why what they do is the same.
    """

    file: str
    old: str
    new: str
    reason: str


def named_mutants() -> list[Mutant]:
    """Return the mutants that have names.

    Raises:
        ValueError: Two have the same name, or one changes a module without tests.
    """
    found: dict[str, Mutant] = {}
    known = modules()
    for path in sorted((_HERE / "named").glob("*.toml")):
        for row in _read(path)["mutant"]:
            tests = tuple(row.pop("tests", ()))
            mutant = Mutant(**row, tests=tests)
            if mutant.name in found:
                raise ValueError(f"{path.name}: {mutant.name} is there twice")
            if mutant.file not in known:
                raise ValueError(f"{path.name}: plan.toml names no tests of {mutant.file}")
            found[mutant.name] = mutant
    return list(found.values())


def modules() -> dict[str, Module]:
    """Return the modules by their file, in the order of ``plan.toml``."""
    return {
        file: Module(file, row["room"], row.get("drawn", True), tuple(row["tests"]))
        for file, row in _read(_HERE / "plan.toml")["modules"].items()
    }


def equivalents() -> list[Equivalent]:
    """Return the mutants that no test can find."""
    return [Equivalent(**row) for row in _read(_HERE / "equivalent.toml").get("mutant", ())]


def _read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text())
