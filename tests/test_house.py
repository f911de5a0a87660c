"""The rooms of the house: who may import whom, and what a client need not have."""

from __future__ import annotations

import ast
import functools
import json
import subprocess
import sys
from pathlib import Path

import pytest

import ikplan

SOURCE = Path(ikplan.__file__).parent
API = SOURCE.parent / "api" / "ikplan_api"
RANK = {
    "errors": 0,
    "robots": 1,
    "kinematics": 2,
    "ik": 3,
    "path": 3,
    "planning": 4,
    "timing": 4,
    "certificate": 4,
    "pipeline": 5,
    "cli": 6,
    "client": 6,
    "ikplan_api": 7,
}
"""api -> cli, client -> pipeline -> certificate, timing, planning -> path, ik -> kinematics ->
robots -> errors. Rooms without a rank serve them: what they import counts for who imports them."""


@functools.cache
def modules() -> dict[str, Path]:
    """Every module by its name."""
    found = {}
    for package in (SOURCE, API):
        for file in package.rglob("*.py"):
            parts = [package.name, *file.relative_to(package).with_suffix("").parts]
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


def type_checking(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)


@functools.cache
def imports(module: str, *, lazy: bool = False) -> frozenset[str]:
    """Modules of ours that a module imports when it is imported; ``lazy``: or when it runs."""
    found: set[str] = set()
    pending: list[ast.AST] = [ast.parse(modules()[module].read_text())]
    while pending:
        node = pending.pop()
        names: list[str] = []
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module} has a relative import"
            names = [f"{node.module}.{a.name}" for a in node.names]
            names = [n if n in modules() else str(node.module) for n in names]
        elif isinstance(node, ast.Import):
            names = [a.name for a in node.names]
        found |= {n for n in names if n in modules()}
        for child in ast.iter_child_nodes(node):
            function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
            if not (isinstance(child, ast.stmt) and type_checking(child)) and (
                lazy or not function
            ):
                pending.append(child)
    return frozenset(found)


def room(module: str) -> str:
    parts = module.split(".")
    return parts[0] if parts[0] == "ikplan_api" or len(parts) == 1 else parts[1]


@functools.cache
def reached(module: str) -> frozenset[str]:
    """Every module that importing a module brings in."""
    seen: set[str] = set()
    pending = [module]
    while pending:
        current = pending.pop()
        if current not in seen:
            seen.add(current)
            pending += imports(current)
    return frozenset(seen)


@pytest.mark.parametrize("name", [m for m in sorted(modules()) if room(m) in RANK])
def test_imports_run_one_way(name: str) -> None:
    rank = RANK[room(name)]
    above = {m for m in reached(name) if RANK.get(room(m), -1) > rank}
    assert not above, f"{name} brings in {above}"
    above = {m for m in imports(name, lazy=True) if RANK.get(room(m), -1) > rank}
    assert not above, f"{name} imports {above} when it runs"


def test_there_are_no_circles() -> None:
    for name in modules():
        for other in imports(name):
            # A package's own parts import it by name without needing its contents.
            if other != name:
                assert name not in reached(other) or other == "ikplan", f"{name} <-> {other}"


def test_the_library_does_not_know_the_service() -> None:
    for name in modules():
        if not name.startswith("ikplan_api"):
            assert not {m for m in imports(name, lazy=True) if m.startswith("ikplan_api")}


def modules_after(statement: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", f"{statement}; import json, sys; print(json.dumps([*sys.modules]))"],
        capture_output=True,
        text=True,
        check=True,
    )
    return {m.split(".")[0] for m in json.loads(done.stdout.splitlines()[-1])}


HEAVY = {"pinocchio", "numba", "llvmlite", "scipy", "toppra", "matplotlib", "fastapi", "uvicorn"}


@pytest.mark.parametrize(
    ("statement", "none_of"),
    [
        ("import ikplan", HEAVY | {"numpy", "pydantic", "httpx"}),
        ("from ikplan import Client, AsyncClient, Plan, PlanRequest, IkplanError", HEAVY),
        ("import ikplan; dir(ikplan); ikplan.__version__", HEAVY | {"numpy", "pydantic"}),
    ],
)
def test_a_client_needs_neither_pinocchio_nor_a_compiler(statement: str, none_of: set[str]) -> None:
    assert not modules_after(statement) & none_of


def test_every_public_name_is_there_and_in_order() -> None:
    assert ikplan.__all__ == sorted(ikplan.__all__)
    assert set(dir(ikplan)) == set(ikplan.__all__)
    for name in ikplan.__all__:
        assert getattr(ikplan, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'plans'"):
        _ = ikplan.plans  # type: ignore[attr-defined]
