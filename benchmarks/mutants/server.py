"""A process that has everything imported, and a child of it for each run of tests.

``python -m benchmarks.mutants.server`` in a room. Importing the libraries and loading the compiled
kernels takes several seconds; it is done once. A child forgets the module that was changed and
every module that imports it, imports them anew, and runs the tests: the rest, and the kernels in
it, stay. So kernels that only import a changed module are never compiled anew. Each line of the
standard input is a :class:`Run` in JSON, each line of the standard output its :class:`Outcome`.
"""

from __future__ import annotations

import ast
import contextlib
import importlib
import json
import os
import pkgutil
import resource
import select
import signal
import sys
import time
import traceback
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

__all__ = ["Outcome", "Run", "dependents", "imports_of"]

_MEMORY = 12 * 2**30
"""Most address space of a child [bytes]; compiled code and libraries take about 3 GiB of it."""
_SOLVERS = ("ik-ba", "lm")
_OPTIONS = (
    *("-x", "--no-header", "--tb=short", "-p", "no:cacheprovider", "-p", "no:schemathesis"),
    *("-W", "ignore::pytest.PytestAssertRewriteWarning"),
)
"""The last, since hypothesis is imported before pytest gets to it."""
_UNUSABLE = 101
"""Exit code of a child whose pytest broke off by an error of its own."""
_NO_IMPORT = 100
"""Exit code of a child that could not import the package."""


@dataclass(frozen=True)
class Run:
    """Tests to run.

    Attributes:
        module: The module that was changed; None: none.
        interpreted: Whether the kernels of that module, and of those that import it, run as
            Python.
        tests: Test files or node ids, in the order they run.
        timeout: Seconds after which the run is ended.
        log: File for what the tests print.
    """

    module: str | None
    interpreted: bool
    tests: list[str]
    timeout: float
    log: str


@dataclass(frozen=True)
class Outcome:
    """What came of a run.

    Attributes:
        result: "passed", "failed", "timeout", "import" (the package cannot be imported), "crash"
            (ended by a signal), or "unusable" (pytest found no tests or could not run).
        seconds: How long it took.
    """

    result: str
    seconds: float


def imports_of(module: str, source: str, known: Iterable[str]) -> set[str]:
    """Return the modules that a module imports when it is imported.

    Args:
        module: Its name.
        source: Its text.
        known: The names that count.
    """
    known = set(known)
    found: set[str] = set()
    pending: list[ast.AST] = [ast.parse(source)]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        for child in ast.iter_child_nodes(node):
            function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
            typing = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test)
            if not function and not typing:
                pending.append(child)
    return (found & known) - {module}


def dependents(module: str, imports: dict[str, set[str]]) -> set[str]:
    """Return a module and all that import it, directly or not.

    Args:
        module: The module.
        imports: What each module imports.
    """
    found, pending = {module}, [module]
    while pending:
        current = pending.pop()
        above = {name for name, names in imports.items() if current in names} - found
        found |= above
        pending += sorted(above)
    return found


def _preload() -> dict[str, set[str]]:
    """Import the package and load its kernels; return what each module imports."""
    for name in ("pytest", "hypothesis", "toppra", "matplotlib.pyplot", "scipy.interpolate"):
        importlib.import_module(name)
    package = importlib.import_module("ikplan")
    for module in pkgutil.walk_packages(package.__path__, "ikplan."):
        if not module.name.startswith(("ikplan.cli", "ikplan.__main__")):
            importlib.import_module(module.name)
    warm_up = importlib.import_module("ikplan.pipeline.warm_up").warm_up
    for method in _SOLVERS:
        warm_up(package.plan, "plan", method)
    warm_up(package.time_request, "time", jerk=True)
    names = [name for name in sys.modules if name.split(".")[0] == "ikplan"]
    return {name: imports_of(name, Path(_file(name)).read_text(), names) for name in names}


def _file(name: str) -> str:
    file = sys.modules[name].__file__
    assert file is not None
    return file


def _import_anew(module: str, imports: dict[str, set[str]]) -> None:
    """Forget a module and all that import it, and import them again."""
    names = sorted(dependents(module, imports))
    for name in names:
        del sys.modules[name]
    for name in names:
        importlib.import_module(name)
    # What was not imported anew is still a part of its package, which may be a new one; where a
    # package has something else by that name, as a function out of the module, it keeps it.
    for name in sorted(imports):
        parent, _, last = name.rpartition(".")
        if parent and not hasattr(sys.modules[parent], last):
            setattr(sys.modules[parent], last, sys.modules[name])


@contextlib.contextmanager
def _uncompiled() -> Iterator[None]:
    """Leave the kernels of what is imported meanwhile uncompiled; others still may be compiled."""
    import numba
    import numpy as np

    os.environ["NUMBA_DISABLE_JIT"] = "1"
    numba.config.DISABLE_JIT = 1
    # As in compiled code, a division by zero is no warning.
    np.seterr(all="ignore")
    try:
        yield
    finally:
        numba.config.DISABLE_JIT = 0
        del os.environ["NUMBA_DISABLE_JIT"]


def _child(run: Run, imports: dict[str, set[str]]) -> int:
    """Run tests and return an exit code."""
    import hypothesis
    import pytest

    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # The first failure is enough: it need not be made small.
    phases = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
    hypothesis.settings.register_profile(
        "mutants", phases=phases, database=None, deadline=None, derandomize=True
    )
    hypothesis.settings.load_profile("mutants")
    if run.module is not None:
        try:
            with _uncompiled() if run.interpreted else contextlib.nullcontext():
                _import_anew(run.module, imports)
        except Exception:
            traceback.print_exc()
            return _NO_IMPORT
    return int(pytest.main([*_OPTIONS, *run.tests]))


def _redirect(log: str) -> None:
    out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    nothing = os.open(os.devnull, os.O_RDONLY)
    for source, target in ((nothing, 0), (out, 1), (out, 2)):
        os.dup2(source, target)


def _fork(run: Run, imports: dict[str, set[str]]) -> Outcome:
    begin = time.monotonic()
    pid = os.fork()
    if pid == 0:
        code = _UNUSABLE
        try:
            os.setpgid(0, 0)
            _redirect(run.log)
            code = _child(run, imports)
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    handle = os.pidfd_open(pid)
    poll = select.poll()
    poll.register(handle, select.POLLIN)
    late = not poll.poll(1000.0 * run.timeout)
    # Whatever the tests have started ends with them.
    with contextlib.suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)
    _, status = os.waitpid(pid, 0)
    os.close(handle)
    seconds = time.monotonic() - begin
    if late:
        return Outcome("timeout", seconds)
    if os.WIFSIGNALED(status):
        return Outcome("crash", seconds)
    code = os.waitstatus_to_exitcode(status)
    results = {0: "passed", 1: "failed", 2: "failed", _NO_IMPORT: "import"}
    return Outcome(results.get(code, "unusable"), seconds)


def main() -> None:
    """Serve runs until the standard input ends."""
    imports = _preload()
    print(json.dumps({"ready": len(imports)}), flush=True)
    for line in sys.stdin:
        print(json.dumps(asdict(_fork(Run(**json.loads(line)), imports))), flush=True)


if __name__ == "__main__":
    main()
