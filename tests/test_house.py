"""The rooms of the house: who may import whom, and what a client need not have."""

from __future__ import annotations

import ast
import functools
import graphlib
import importlib
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import ikplan

SOURCE = Path(ikplan.__file__).parent
API = SOURCE.parent / "api" / "ikplan_api"
RANK = {
    "processor_time": -2,
    "_kernels": -1,
    "_jit": 0,
    "_lazy": 0,
    "_version": 0,
    "arrays": 0,
    "copying": 1,
    "sorting": 1,
    "errors": 0,
    "documents": 1,
    "time_budget": 1,
    "robots": 2,
    "kinematics": 3,
    "limits": 3,
    "gcode": 3,
    "points": 3,
    "smoothing": 3,
    "scene": 3,
    "joint_path": 4,
    "path": 4,
    "collision": 4,
    "ik": 5,
    "certificate": 6,
    "planning": 6,
    "timing": 6,
    "plans": 7,
    "pipeline": 8,
    "client": 9,
    "workers": 9,
    "reach": 9,
    "arena": 9,
    "batch": 10,
    "placement": 11,
    "cli": 12,
    "ikplan_api": 13,
}
"""The floor of each room. A room imports rooms of lower floors only, never one beside it: planning,
timing and the certificate stand side by side."""
OVER_ALL = {"ikplan", "__main__"}
"""The package itself, which hands out the public names, and its command."""
MOST_MODULES = 20
"""Most modules in a folder of the library; about 15 where they are no catalogue."""
SERVICE_RANK = {
    "cancelling": 0,
    "documentation": 0,
    "settings": 0,
    "telemetry": 0,
    "http": 1,
    "store": 1,
    "workers": 1,
    "connections": 2,
    "jobs": 2,
    "middleware": 2,
    "robots": 2,
    "scenes": 2,
    "handlers": 3,
    "routes": 4,
    "app": 5,
}
"""app -> routes -> handlers -> connections, jobs, middleware, robots, scenes -> http, store,
workers -> cancelling, documentation, settings, telemetry: a room of the service imports rooms of a
lower rank only, never one beside it."""
MOST_FILES = 15
"""Most modules in a folder of the service."""


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


def imports_of(
    source: str, module: str, *, lazy: bool = False, typing: bool = False
) -> frozenset[str]:
    """Modules of ours that a source imports when it is imported.

    Args:
        source: Python code.
        module: Name of its module, for messages.
        lazy: Include imports inside functions.
        typing: Include imports under TYPE_CHECKING.
    """
    found: set[str] = set()
    pending: list[ast.AST] = [ast.parse(source)]
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
            checking = isinstance(child, ast.stmt) and type_checking(child)
            if (typing or not checking) and (lazy or not function):
                pending.append(child)
    return frozenset(found)


@functools.cache
def imports(module: str, *, lazy: bool = False, typing: bool = False) -> frozenset[str]:
    """Modules of ours that a module imports; see :func:`imports_of`."""
    return imports_of(modules()[module].read_text(), module, lazy=lazy, typing=typing)


def room(module: str) -> str:
    parts = module.split(".")
    return parts[0] if parts[0] == "ikplan_api" or len(parts) == 1 else parts[1]


def every_import(module: str) -> frozenset[str]:
    """Modules of ours that a module imports, wherever the import stands."""
    return imports(module, lazy=True, typing=True) - {module}


def test_every_room_has_its_floor() -> None:
    assert {room(name) for name in modules()} - OVER_ALL == set(RANK)


@pytest.mark.parametrize("name", [m for m in sorted(modules()) if room(m) not in OVER_ALL])
def test_imports_run_one_way(name: str) -> None:
    mine = room(name)
    others = {m for m in every_import(name) if room(m) != mine and room(m) != "ikplan"}
    climbs = {m for m in others if RANK[room(m)] >= RANK[mine]}
    assert not climbs, f"{name} imports {climbs}"


def test_modules_form_no_circle() -> None:
    """Neither when they are imported, nor when they run, nor for types."""
    graph = {name: every_import(name) - {"ikplan"} for name in modules()}
    list(graphlib.TopologicalSorter(graph).static_order())  # raises CycleError


def test_folders_of_the_library_are_small() -> None:
    for folder in {path.parent for path in modules().values() if API not in path.parents}:
        assert len(list(folder.glob("*.py"))) <= MOST_MODULES, folder.name


def test_every_folder_of_modules_is_a_package() -> None:
    for folder in {path.parent for path in modules().values()}:
        assert (folder / "__init__.py").is_file(), folder


def service_modules() -> list[str]:
    return [m for m in sorted(modules()) if m.startswith("ikplan_api.")]


def service_imports(module: str) -> frozenset[str]:
    """Modules of the service that a module imports, wherever the import stands."""
    found = imports(module, lazy=True, typing=True)
    return frozenset(m for m in found if m.startswith("ikplan_api."))


def service_room(module: str) -> str:
    return module.split(".")[1]


def test_imports_inside_functions_and_for_types_only_are_read() -> None:
    source = (
        "from ikplan_api.http import body\n"
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n"
        "    from ikplan_api.jobs.plan_jobs import PlanJobs\n"
        "class A:\n"
        "    async def f(self):\n"
        "        import ikplan_api.workers.tasks\n"
    )
    now = {"ikplan_api.http.body"}
    lazy, typing = {"ikplan_api.workers.tasks"}, {"ikplan_api.jobs.plan_jobs"}
    assert imports_of(source, "a") == now
    assert imports_of(source, "a", lazy=True) == now | lazy
    assert imports_of(source, "a", lazy=True, typing=True) == now | lazy | typing


@pytest.mark.parametrize("name", service_modules())
def test_rooms_of_the_service_import_lower_ones_only(name: str) -> None:
    mine = service_room(name)
    others = {m for m in service_imports(name) if service_room(m) != mine}
    assert not {m for m in others if SERVICE_RANK[service_room(m)] >= SERVICE_RANK[mine]}


def test_modules_of_the_service_form_no_circle() -> None:
    graph = {name: service_imports(name) - {name} for name in service_modules()}
    assert sum(map(len, graph.values())) > len(graph)
    list(graphlib.TopologicalSorter(graph).static_order())  # raises CycleError


def test_modules_of_the_service_that_strings_name_exist() -> None:
    named = set()
    for name, file in modules().items():
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                found = re.fullmatch(r"(ikplan_api(?:\.\w+)+)(?::\w+)?", node.value)
                named |= {(name, found[1])} if found else set()
    assert {"ikplan.cli.serving", "ikplan_api.workers.worker_slot"} <= {name for name, _ in named}
    for name, path in named:
        module, _, attribute = path.rpartition(".")
        exists = path in modules() or (
            module in modules() and hasattr(importlib.import_module(module), attribute)
        )
        assert exists, f"{name} names {path}"


def test_folders_of_the_service_are_small_and_ranked() -> None:
    assert {service_room(m) for m in service_modules()} == SERVICE_RANK.keys()
    for folder in (API, *(f for f in API.iterdir() if f.is_dir())):
        assert len(list(folder.glob("*.py"))) <= MOST_FILES


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
        ("from ikplan import read_waypoints; import ikplan.points", HEAVY),
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
    with pytest.raises(AttributeError, match="no attribute 'trajectories'"):
        _ = ikplan.trajectories  # type: ignore[attr-defined]
