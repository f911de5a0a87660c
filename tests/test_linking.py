"""Large kernels are called where they are, small ones are part of their callers."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from numba import types

from ikplan._kernels.linking import Loaded, StaleKernelError
from tests.test_jit import SOURCE, Forge

STEPS = 800
BODY = "\n".join(f"    x = x * 0.5 + {k}.0 / (1.0 + x * x)" for k in range(STEPS))
LARGE = f"""
from ikplan._jit import kernel


@kernel
def large(x: float) -> float:
{BODY}
    return x + SHIFT


SHIFT = {{shift}}


@kernel
def small(x: float) -> float:
    return 2.0 * large(x)
"""
CALLERS = """
import numpy as np

from ikplan._jit import kernel
from ikplan.large import large, small


@kernel
def once(x: float) -> float:
    return large(x)


@kernel
def through_small(x: float) -> float:
    return 1.0 + small(x)


@kernel
def power(x: float, n: int, twice: bool) -> float:
    total = 1.0
    for _ in range(n):
        total *= x
    return total * total if twice else total


@kernel
def powers(x: float) -> tuple[float, float, float]:
    return power(x, 2, False), power(x, 3, False), power(x, 2, True)


@kernel
def rows(n: int) -> np.ndarray:
    return np.ones((n, 2))


@kernel
def total(n: int) -> float:
    return rows(n).sum()
"""
CALL = """
import json
from ikplan import callers, large as file
found = {{"value": callers.{name}(1.5)}}
compiled = [
    name
    for module in (callers, file)
    for name, each in vars(module).items()
    if getattr(each, "stats", None) is not None and each.stats.cache_misses
]
print(json.dumps({{**found, "compiled": sorted(set(compiled))}}))
"""


def expected(x: float, shift: float = 0.0) -> float:
    for k in range(STEPS):
        x = x * 0.5 + k / (1.0 + x * x)
    return x + shift


class Package:
    """Kernels under the project's name, with the project's own ``_jit``."""

    def __init__(self, root: Path, forge: Forge) -> None:
        self.root, self.cache, self.forge = root, root / "cache", forge
        (root / "ikplan").mkdir(parents=True)
        (root / "ikplan" / "__init__.py").touch()
        shutil.copy(SOURCE / "_jit.py", root / "ikplan")
        shutil.copy(SOURCE / "processor_time.py", root / "ikplan")
        shutil.copytree(SOURCE / "_kernels", root / "ikplan" / "_kernels")
        (root / "ikplan" / "callers.py").write_text(CALLERS)
        self.write()

    def write(self, shift: float = 0.0) -> None:
        (self.root / "ikplan" / "large.py").write_text(LARGE.format(shift=shift))

    def call(self, name: str) -> Any:
        answer, said = self.forge.run(CALL.format(name=name), self.root, self.cache)
        assert bool(answer["compiled"]) == bool(said), said
        return answer

    def run(self, script: str) -> Any:
        return self.forge.run(script, self.root, self.cache)[0]

    def kept(self, name: str) -> list[bytes]:
        return [file.read_bytes() for file in self.cache.rglob(f"{name}-*.nbc")]


@pytest.fixture(scope="module")
def forge(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Forge]:
    made = Forge(tmp_path_factory.mktemp("forge"))
    yield made
    made.process.communicate()


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory, forge: Forge) -> Package:
    """Every kernel is compiled."""
    made = Package(tmp_path_factory.mktemp("package"), forge)
    assert made.call("once")["compiled"] == ["large", "once"]
    assert made.call("through_small")["compiled"] == ["small", "through_small"]
    return made


def test_a_caller_that_was_kept_finds_the_large_kernel_that_it_calls(package: Package) -> None:
    assert package.call("once") == {"value": expected(1.5), "compiled": []}


def test_a_large_kernel_is_found_through_a_small_one_that_is_part_of_the_caller(
    package: Package,
) -> None:
    assert package.call("through_small") == {"value": 1.0 + 2.0 * expected(1.5), "compiled": []}


def test_a_large_kernel_is_not_part_of_its_callers(package: Package) -> None:
    largest = max(len(each) for each in package.kept("callers.once"))
    (own,) = package.kept("large.large")
    assert largest < 0.7 * len(own)


def test_a_large_kernel_that_is_lost_is_compiled_again_and_its_caller_is_not(
    package: Package,
) -> None:
    for file in package.cache.rglob("large.large-*"):
        file.unlink()
    assert package.call("once") == {"value": expected(1.5), "compiled": ["large"]}
    assert package.call("once") == {"value": expected(1.5), "compiled": []}


def test_a_caller_is_compiled_again_with_a_large_kernel_that_changes(
    tmp_path: Path, forge: Forge
) -> None:
    package = Package(tmp_path, forge)
    package.call("once")
    package.write(shift=100.0)
    changed = {"value": expected(1.5, 100.0), "compiled": ["large", "once"]}
    assert package.call("once") == changed


VALUES = types.Array(types.float64, 1, "C")
TAKEN = (VALUES, VALUES, VALUES, types.float64, types.float64)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("clip_inside", TAKEN),
        ("clip_inside", ()),
        ("clip_inside", (*TAKEN, types.float64)),
        ("clip_inside", (*TAKEN[:3], types.float64, types.unicode_type)),
        ("no_such_kernel", ()),
    ],
)
def test_what_was_compiled_with_another_kernel_of_that_name_is_stale(
    name: str, arguments: tuple[Any, ...]
) -> None:
    with pytest.raises(StaleKernelError, match=f"{name} is not what .* remove the caller"):
        Loaded("ikplan.kinematics.bounds", name, arguments, "_ZN5other")()


def test_numbers_that_are_written_where_a_kernel_is_called_make_no_kernels(
    package: Package,
) -> None:
    script = """
import json
from ikplan.callers import power, powers
print(json.dumps([*powers(3.0), len(power.overloads)]))
"""
    assert package.run(script) == [9.0, 27.0, 81.0, 1]


def test_a_kernel_that_kernels_called_first_is_called_from_python_later(package: Package) -> None:
    first = "import json; from ikplan.callers import total; print(json.dumps(total(3)))"
    assert package.run(first) == 6.0
    assert len(package.kept("callers.rows")) == 1
    later = """
import gc, json
from ikplan.callers import rows
made = [rows(2).tolist()]
gc.collect()
print(json.dumps([*made, rows(1).tolist(), rows.stats.cache_misses == {}]))
"""
    assert package.run(later) == [[[1.0, 1.0], [1.0, 1.0]], [[1.0, 1.0]], True]
    assert len(package.kept("callers.rows")) == 2
    assert package.run(later)[2] is True
    assert len(package.kept("callers.rows")) == 2
