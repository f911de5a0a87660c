"""What docs/solvers.md says is true: its table, and every example on it."""

from __future__ import annotations

import re
import types
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

import ikplan._jit
from ikplan.ik.registry import solvers
from ikplan.ik.solver import Solver, common_parameters
from tests.ik.metaheuristics.runs import problem

PAGE = (Path(__file__).parents[2] / "docs" / "solvers.md").read_text()
RAW, COMPARE, KERNEL, ENTRY = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def row(solver: Solver) -> str:
    """The row of a solver."""
    paper = f"{solver.population}, {solver.iterations}" if solver.population else "-"
    own = f"{solver.planner_population}, {solver.planner_iterations}"
    own = own if solver.planner_population else "-"
    return f"| `{solver.name}` | {solver.title} | {paper} | {own} | {solver.evaluations} |"


def executed(source: str) -> types.SimpleNamespace:
    """The names that an example makes."""
    names: dict[str, Any] = {"__name__": "example"}
    exec(compile(source, "docs/solvers.md", "exec"), names)
    return types.SimpleNamespace(**names)


def test_the_table_is_that_of_the_registry() -> None:
    rows = [line for line in PAGE.splitlines() if line.startswith("| `") and line.count("|") == 6]
    assert rows == [row(solver) for solver in solvers()]


def test_every_common_parameter_is_named() -> None:
    for parameter in common_parameters():
        assert f"`{parameter.name}`" in PAGE
        for choice in set(parameter.choices or []):
            assert f"`{choice}`" in PAGE


def test_raw_and_refined() -> None:
    executed(RAW)


def test_solvers_are_compared_at_about_equal_evaluations(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = executed(COMPARE)
    printed = [float(v) for v in capsys.readouterr().out.split()]
    assert printed[:2] == [np.median(found.a), np.median(found.b)]
    assert (np.array([found.a, found.b]) < 0.2).all()
    assert 0.0 <= printed[2] <= 1.0


def test_the_example_search_keeps_the_laws(monkeypatch: pytest.MonkeyPatch) -> None:
    # The cache of kernels is for files of the package.
    monkeypatch.setattr(ikplan._jit, "kernel", numba.njit)
    example, entry = executed(KERNEL), executed(ENTRY).WALK
    values = entry.check({})
    params = example.WalkParams(*(values[p.name] for p in entry.own_parameters()))
    assert example.WalkParams._fields == tuple(p.name for p in entry.own_parameters())
    task = problem(4, 12, 60)
    first, again = (example.walk(task, params, np.random.default_rng(1)) for _ in range(2))
    np.testing.assert_array_equal(first.x, again.x)
    assert first.evaluations[0] == 12 + 12 * 60
    assert (np.diff(first.history) <= 0.0).all()
    assert first.f[0] < 1e-3
    task.cut[0] = True
    assert example.walk(task, params, np.random.default_rng(1)).iterations[0] == 0
