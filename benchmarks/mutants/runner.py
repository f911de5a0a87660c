"""Runs many mutants, some at a time."""

from __future__ import annotations

import contextlib
import queue
import re
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from benchmarks.mutants.catalogue import Module
from benchmarks.mutants.kernels import changes_kernels
from benchmarks.mutants.mutant import Mutant
from benchmarks.mutants.rooms import ROOT
from benchmarks.mutants.slot import Slot

__all__ = ["BaselineError", "Verdict", "run_mutants"]

_TIMES, _MORE_S = 4.0, 10.0
"""A run may take this many times as long as with the code as it is, and this much more."""
_LONGEST_S = 600.0
_FAILED = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)
_Part = tuple[str, str | None]


class BaselineError(Exception):
    """A test does not pass with the code as it is, or cannot be run."""


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant.

    Attributes:
        mutant: The mutant.
        result: "passed" (it survived) or how it was found, see :class:`.server.Outcome`.
        seconds: How long that took.
        by: The test that found it.
    """

    mutant: Mutant
    result: str
    seconds: float
    by: str

    @property
    def survived(self) -> bool:
        """Whether no test found it."""
        return self.result == "passed"


def run_mutants(
    mutants: Sequence[Mutant],
    modules: dict[str, Module],
    processes: int,
    tell: Callable[[Verdict], None],
) -> tuple[list[Verdict], float]:
    """Run the tests of mutants, after each test once with the code as it is.

    Args:
        mutants: The mutants.
        modules: The tests of each module.
        processes: How many at a time.
        tell: Is called with each verdict, one at a time.

    Returns:
        The verdicts in the order of the mutants, and the seconds that the code as it is took.

    Raises:
        BaselineError: A test fails with the code as it is.
    """
    interpreted = {m: changes_kernels((ROOT / "ikplan" / m.file).read_text(), m) for m in mutants}
    tests = {m: [*m.tests, *_rest(m.tests, modules[m.file])] for m in mutants}

    def parts(mutant: Mutant) -> list[_Part]:
        """The tests of a mutant one by one, each with the module whose kernels run as Python."""
        return [(test, mutant.file if interpreted[mutant] else None) for test in tests[mutant]]

    every = list(dict.fromkeys(part for mutant in mutants for part in parts(mutant)))
    with contextlib.ExitStack() as stack, ThreadPoolExecutor(processes) as pool:
        free: queue.SimpleQueue[Slot] = queue.SimpleQueue()
        for slot in pool.map(lambda _: Slot(), range(processes)):
            free.put(stack.enter_context(slot))

        def baseline(part: _Part) -> float:
            test, uncompiled = part
            with _taken(free) as slot:
                outcome = slot.run(uncompiled, uncompiled is not None, [test], _LONGEST_S)
                if outcome.result != "passed":
                    how = "" if uncompiled is None else f" with {uncompiled} uncompiled"
                    raise BaselineError(f"{test}{how}: {outcome.result}\n{slot.printed()[-3000:]}")
                return outcome.seconds

        begin = time.monotonic()
        took = dict(zip(every, pool.map(baseline, every), strict=True))
        before = time.monotonic() - begin

        def run(mutant: Mutant) -> Verdict:
            usual = sum(took[part] for part in parts(mutant))
            timeout = _TIMES * usual + _MORE_S
            with _taken(free) as slot:
                outcome = slot.run_mutant(mutant, tests[mutant], interpreted[mutant], timeout)
                printed = slot.printed()
            if outcome.result == "unusable":
                raise BaselineError(f"{mutant.name} of {mutant.file}\n{printed[-3000:]}")
            found = _FAILED.search(printed)
            by = found[1] if found and outcome.result == "failed" else ""
            return Verdict(mutant, outcome.result, outcome.seconds, by)

        verdicts = []
        for verdict in pool.map(run, mutants):
            tell(verdict)
            verdicts.append(verdict)
    return verdicts, before


@contextlib.contextmanager
def _taken(free: queue.SimpleQueue[Slot]) -> Iterator[Slot]:
    slot = free.get()
    try:
        yield slot
    finally:
        free.put(slot)


def _rest(first: Sequence[str], module: Module) -> list[str]:
    """The tests of a module that do not run before."""
    return [test for test in module.tests if test not in first]
