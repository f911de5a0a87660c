"""A room and the server in it: runs tests of one mutant at a time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path
from types import TracebackType

from benchmarks.mutants.mutant import Mutant
from benchmarks.mutants.rooms import Room
from benchmarks.mutants.server import Outcome, Run

__all__ = ["Slot", "module_name"]

_SINGLE = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS")


def module_name(file: str) -> str:
    """Return the dotted name of a module of the package."""
    parts = ["ikplan", *Path(file).with_suffix("").parts]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


class Slot:
    """Copies the checkout and starts a server there; a context manager ends and removes both."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="ikplan-mutants-")
        root = Path(self._folder.name)
        self._room = Room(root / "room")
        self._log = root / "log"
        paths = f"{self._room.folder}{os.pathsep}{self._room.folder / 'api'}"
        environment = {**os.environ, "PYTHONPATH": paths, **dict.fromkeys(_SINGLE, "1")}
        self._server = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.mutants.server"],
            cwd=self._room.folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._answer()

    def __enter__(self) -> Slot:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._server.terminate()
        self._server.wait()
        self._folder.cleanup()

    def run_mutant(
        self, mutant: Mutant, tests: list[str], interpreted: bool, timeout: float
    ) -> Outcome:
        """Plant a mutant and run tests of it.

        Args:
            mutant: The mutant.
            tests: Test files or node ids, in the order they run; the first failure ends it.
            interpreted: Whether the kernels of the module run as Python.
            timeout: Seconds after which it is ended.
        """
        source = self._room.source(mutant.file)
        self._room.write(mutant.file, mutant.apply(source))
        try:
            return self.run(mutant.file, interpreted, tests, timeout)
        finally:
            self._room.write(mutant.file, source)

    def run(self, file: str | None, interpreted: bool, tests: list[str], timeout: float) -> Outcome:
        """Run tests, with a module, if one is given, imported anew."""
        module = None if file is None else module_name(file)
        run = Run(module, interpreted, tests, timeout, str(self._log))
        assert self._server.stdin is not None
        self._server.stdin.write(json.dumps(asdict(run)) + "\n")
        self._server.stdin.flush()
        return Outcome(**json.loads(self._answer()))

    def printed(self) -> str:
        """Return what the tests of the last run printed."""
        return self._log.read_text(errors="replace") if self._log.is_file() else ""

    def _answer(self) -> str:
        assert self._server.stdout is not None
        line = self._server.stdout.readline()
        if not line:
            raise RuntimeError(f"the server of {self._room.folder} has ended: see above")
        return line
