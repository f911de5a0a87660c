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
from ikplan.ik import registry
from ikplan.ik.registry import solvers
from ikplan.ik.solver import Solver, common_parameters
from tests.ik.metaheuristics.runs import problem

PAGE = (Path(__file__).parents[2] / "docs" / "solvers.md").read_text()
RAW, COMPARE, OWN, KERNEL, ENTRY = re.findall(
    r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL
)


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


def test_the_example_of_a_comparison_prints_its_table(capsys: pytest.CaptureFixture[str]) -> None:
    found = executed(COMPARE)
    assert capsys.readouterr().out == found.found.table() + "\n"
    assert set(found.found.tests.ranks) == {"ik-ba", "de-best-1"}


def test_the_example_of_a_solver_from_outside_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "_registered", {})
    executed(OWN)
    assert [s.name for s in solvers() if s.family == "outside"] == ["descent"]


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
