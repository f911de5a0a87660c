"""Runs a notebook without Jupyter: its cells in order, in one namespace."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "examples" / "notebooks"


def read(name: str) -> dict[str, Any]:
    """The document of a notebook."""
    document: dict[str, Any] = json.loads((FOLDER / f"{name}.ipynb").read_text())
    return document


def run(name: str) -> tuple[dict[str, Any], list[Any]]:
    """Run a notebook.

    Returns:
        Its names, and what each cell of code shows: the value of its last line, or None.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    shown: list[Any] = []
    for i, cell in enumerate(read(name)["cells"]):
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]))
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        where = f"{name}.ipynb, cell {i}"
        exec(compile(tree, where, "exec"), names)
        value = None
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), where, "eval"), names)
        shown.append(value)
    return names, shown
