"""Compiled kernels are cached by the content of all they are built of."""

from __future__ import annotations

import ast
import functools
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import ikplan
from ikplan._kernels.sources import sources_of

SOURCE = Path(ikplan.__file__).parent

BASE = """
from ikplan._jit import kernel

FACTOR = {factor}


@kernel
def scaled(x: float) -> float:
    return FACTOR * x
"""
TOP = """
from ikplan._jit import kernel
from ikplan.inner.base import (
    FACTOR,
    scaled,
)


@kernel
def twice(x: float) -> float:
    return scaled(x) + scaled(x)
"""
SCRIPT = """
import json, sys
from ikplan.top import twice
print(json.dumps({"value": twice(3.0), "compiled": bool(twice.stats.cache_misses)}))
"""


DRIVER = """
import contextlib, json, os, sys
import numba  # what takes a second, paid once for all children

for line in sys.stdin:
    job = json.loads(line)
    child = os.fork()
    if child == 0:
        os.environ["IKPLAN_CACHE_DIR"] = job["cache"]
        sys.path.insert(0, job["root"])
        sys.dont_write_bytecode = True
        with open(job["out"], "w") as out, open(job["err"], "w") as err:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                try:
                    exec(job["script"], {})
                except BaseException as error:
                    print(repr(error), file=err)
        os._exit(0)
    if job["wait"]:
        os.waitpid(child, 0)
    else:
        job["child"] = child
    print(json.dumps(job.get("child")), flush=True)
    if job.get("children"):
        for other in job["children"]:
            os.waitpid(other, 0)
        print("null", flush=True)
"""


class Forge:
    """Runs scripts in processes of their own, which begin where numba is imported."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.count = folder, 0
        self.process = subprocess.Popen(
            [sys.executable, "-c", DRIVER],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=folder,
        )

    def start(self, script: str, root: Path, cache: Path, **more: Any) -> tuple[Path, Path, Any]:
        self.count += 1
        out, err = (self.folder / f"{self.count}.{kind}" for kind in ("out", "err"))
        job = {"script": script, "root": str(root), "cache": str(cache), "wait": True, **more}
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(
            json.dumps({**job, "out": str(out), "err": str(err)}),
            file=self.process.stdin,
            flush=True,
        )
        child = json.loads(self.process.stdout.readline())
        if more.get("children"):
            self.process.stdout.readline()
        return out, err, child

    def run(self, script: str, root: Path, cache: Path) -> tuple[Any, str]:
        """The script's answer, as JSON, and its stderr."""
        out, err, _ = self.start(script, root, cache)
        assert out.read_text(), err.read_text()
        return json.loads(out.read_text()), err.read_text()


@pytest.fixture(scope="module")
def forge(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Forge]:
    made = Forge(tmp_path_factory.mktemp("forge"))
    yield made
    made.process.communicate()


class Package:
    """A small package under the project's name, with the project's own ``_jit``."""

    def __init__(self, root: Path, forge: Forge) -> None:
        self.root, self.cache, self.forge = root, root / "cache", forge
        inner = root / "ikplan" / "inner"
        inner.mkdir(parents=True)
        (root / "ikplan" / "__init__.py").touch()
        (inner / "__init__.py").touch()
        shutil.copy(SOURCE / "_jit.py", root / "ikplan" / "_jit.py")
        shutil.copy(SOURCE / "processor_time.py", root / "ikplan")
        shutil.copytree(SOURCE / "_kernels", root / "ikplan" / "_kernels")
        (root / "ikplan" / "top.py").write_text(TOP)
        self.write(factor=2.0)

    def write(self, factor: float) -> None:
        (self.root / "ikplan" / "inner" / "base.py").write_text(BASE.format(factor=factor))

    def run(self, cache: Path | None = None) -> tuple[dict[str, Any], str]:
        """Call the kernel in a process of its own; its answer and its stderr."""
        return self.forge.run(SCRIPT, self.root, cache or self.cache)

    def digest(self) -> str:
        """The digest of the outer kernel's file."""
        file = str(self.root / "ikplan" / "top.py")
        script = (
            "import json; from pathlib import Path; from ikplan._kernels import sources; "
            f"print(json.dumps(sources.digest_of(Path({file!r}))))"
        )
        return str(self.forge.run(script, self.root, self.cache)[0])


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory, forge: Forge) -> Package:
    return Package(tmp_path_factory.mktemp("package"), forge)


def test_kernels_are_compiled_once_and_again_when_what_they_call_changes(package: Package) -> None:
    package.write(factor=2.0)
    first, said = package.run()
    assert first == {"value": 12.0, "compiled": True}
    # Two kernels were compiled, and it is said once.
    assert said == "compiling kernels, once ...\n"

    again, said = package.run()
    assert again == {"value": 12.0, "compiled": False}
    assert said == ""

    # Only the file of the inner kernel changes, and only a constant of it.
    package.write(factor=5.0)
    changed, said = package.run()
    assert changed == {"value": 30.0, "compiled": True}
    assert said == "compiling kernels, once ...\n"

    # The older kernels are still there.
    package.write(factor=2.0)
    assert package.run() == ({"value": 12.0, "compiled": False}, "")


def test_a_file_that_changes_after_its_import_leaves_no_kernel_of_what_it_was(
    package: Package, tmp_path: Path
) -> None:
    package.write(factor=2.0)
    file = package.root / "ikplan" / "inner" / "base.py"
    edited = (
        "import json, pathlib\n"
        "from ikplan.top import twice\n"
        f"pathlib.Path({str(file)!r}).write_text({BASE.format(factor=7.0)!r})\n"
        "print(json.dumps(twice(3.0)))"
    )
    assert package.forge.run(edited, package.root, tmp_path)[0] == 12.0
    assert package.run(tmp_path)[0] == {"value": 42.0, "compiled": True}


def test_a_cache_that_was_cut_short_is_made_again(package: Package) -> None:
    package.write(factor=3.0)
    package.run()
    for pattern in ("*.nbi", "*.nbc"):
        for file in (package.cache / "kernels").rglob(pattern):
            file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
        broken, _ = package.run()
        assert broken == {"value": 18.0, "compiled": True}
        mended, said = package.run()
        assert mended == {"value": 18.0, "compiled": False}
        assert said == ""


def test_a_folder_that_cannot_be_written_costs_time_and_nothing_else(
    package: Package, tmp_path: Path
) -> None:
    package.write(factor=4.0)
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    for _ in range(2):
        answer, said = package.run(blocked / "cache")
        assert answer == {"value": 24.0, "compiled": True}
        assert "compiling kernels, once ..." in said
        assert said.count("cannot be kept") == 1
        assert "IKPLAN_CACHE_DIR" in said


@pytest.mark.skipif(os.getuid() == 0, reason="root writes into every folder")
def test_kernels_are_read_from_a_folder_that_cannot_be_written(package: Package) -> None:
    package.write(factor=6.0)
    package.run()
    folders = [package.cache, *(p for p in package.cache.rglob("*") if p.is_dir())]
    for folder in folders:
        folder.chmod(0o555)
    try:
        assert package.run() == ({"value": 36.0, "compiled": False}, "")
    finally:
        for folder in folders:
            folder.chmod(0o755)


def test_reading_kernels_writes_nothing(package: Package) -> None:
    """What root cannot be refused, it still must not do: a warm cache stays as it is."""
    package.write(factor=7.0)
    package.run()
    before = {p: p.stat().st_mtime_ns for p in package.cache.rglob("*")}
    assert package.run()[0]["compiled"] is False
    assert {p: p.stat().st_mtime_ns for p in package.cache.rglob("*")} == before


def test_processes_that_compile_at_once_do_not_mix_up_their_kernels(
    tmp_path: Path, forge: Forge
) -> None:
    """One kernel for floats in one process and for integers in the other."""
    package = Package(tmp_path, forge)
    for _ in range(3):
        script = "from ikplan.inner.base import scaled; print(scaled({}))"
        first, _, child = forge.start(script.format("3.0"), package.root, package.cache, wait=False)
        second, *_ = forge.start(script.format("3"), package.root, package.cache, children=[child])
        assert [float(out.read_text()) for out in (first, second)] == [6.0, 6.0]
    # No file is named twice, whoever came first.
    named = len(list(package.cache.rglob("*.nbc")))
    assert named >= 2


@functools.cache
def absolute_imports(file: Path) -> set[str]:
    """Modules of ikplan that a file takes names from when it runs."""
    found = set()
    for node in ast.parse(file.read_text()).body:
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: kernels are imported by absolute names"
            if re.match(r"ikplan(?!\._kernels)", str(node.module)):
                found.add(str(node.module))
    return found


KERNEL_FILES = [f for f in sorted(SOURCE.rglob("*.py")) if "kernel\ndef " in f.read_text()]


@pytest.mark.parametrize("file", KERNEL_FILES, ids=lambda f: str(f.relative_to(SOURCE)))
def test_every_file_that_a_kernel_is_built_of_is_in_its_digest(file: Path) -> None:
    sources = sources_of(file)
    assert file in sources
    pending, seen = [file], set()
    while pending:
        current = pending.pop()
        if current in seen:
            continue
        seen.add(current)
        for module in absolute_imports(current):
            target = SOURCE.parent / (module.replace(".", "/") + ".py")
            if not target.is_file():
                # Names taken from a package: whatever is re-exported there escapes the digest.
                names = (SOURCE.parent / module.replace(".", "/") / "__init__.py").read_text()
                assert "kernel" not in names, f"{current} takes names from the package {module}"
                continue
            assert target in sources, f"{target} is not in the digest of {file}"
            pending.append(target)


def test_there_are_kernels() -> None:
    assert len(KERNEL_FILES) > 5


def test_a_digest_changes_with_the_content_of_what_is_imported(
    tmp_path: Path, forge: Forge
) -> None:
    first, same, other = (Package(tmp_path / name, forge) for name in "abc")
    other.write(factor=2.5)
    assert first.digest() == same.digest()
    assert first.digest() != other.digest()


LEAF = """
import numpy as np

from ikplan._jit import kernel, leaf_kernel


@kernel
def total_of_copy(a):
    return a.copy().sum()


@leaf_kernel
def total(a):
    s = 0.0
    for i in range(a.shape[0]):
        s += a[i]
    return s + total_of_copy(a)


@leaf_kernel
def makes_an_array(a):
    return np.empty(3)[0]


@leaf_kernel
def copies_an_array(a):
    a[:] = a
    return 0.0
"""
LEAF_SCRIPT = """
import json
import numpy as np
from numba.core.errors import NumbaError
from ikplan import leaves

a = np.arange(4.0)
refused = []
for name in ("makes_an_array", "copies_an_array"):
    try:
        getattr(leaves, name)(a)
    except NumbaError:
        refused.append(name)
print(json.dumps({"total": leaves.total(a), "refused": refused}))
"""


def test_a_leaf_kernel_that_makes_an_array_is_refused_and_one_that_calls_such_is_not(
    tmp_path: Path, forge: Forge
) -> None:
    package = Package(tmp_path, forge)
    (package.root / "ikplan" / "leaves.py").write_text(LEAF)
    for _ in range(2):  # compiled, and from the cache
        answer, _ = forge.run(LEAF_SCRIPT, package.root, package.cache)
        assert answer == {"total": 12.0, "refused": ["makes_an_array", "copies_an_array"]}
