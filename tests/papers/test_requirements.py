"""A checkout and ``pip install ikplan`` are enough to run the experiments."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
NAMES = {"pinocchio": "pin"}
"""Distributions whose module has another name."""


def imported(path: Path) -> set[str]:
    """Return the names of all top-level modules that a file imports."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module)
    return names


def test_the_experiments_need_nothing_that_the_package_does_not_depend_on() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    brought = {re.split(r"[^\w.-]", line)[0].lower() for line in project["dependencies"]}
    seen: set[Path] = set()
    missing: set[str] = set()
    waiting = sorted((ROOT / "benchmarks" / "papers").glob("*.py"))
    while waiting:
        path = waiting.pop()
        seen.add(path)
        for name in imported(path):
            top = name.partition(".")[0]
            file = ROOT / f"{name.replace('.', '/')}.py"
            if top == "benchmarks" and file.is_file() and file not in seen:
                waiting.append(file)
            elif top not in {"benchmarks", "ikplan", *sys.stdlib_module_names}:
                missing |= {top} - {name for name in NAMES if NAMES[name] in brought} - brought
    assert len(seen) > len(list((ROOT / "benchmarks" / "papers").glob("*.py")))
    assert not missing
