"""Runs one target: every document is read in bounded time and memory, or refused."""

from __future__ import annotations

import resource
import signal
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from hypothesis import HealthCheck, Phase, given, seed, settings, target

from benchmarks.fuzz.targets import TARGETS
from ikplan.errors import IkplanError

__all__ = ["MOST_S", "Report", "fuzz"]

MOST_S = 2.0
"""Longest processor time that reading a document may take [s]."""
_KILLED_S = 20
"""Processor time after which a process is ended that reads a document [s]."""
_MOST_FAULTS = 10

Watch = Callable[[bytes], None]


class Report(NamedTuple):
    """What came of a target.

    Attributes:
        read: Documents that were read.
        refused: Documents that were refused with an error of the library.
        slowest_s: Longest processor time of a document [s].
        growth_bytes: Growth of the process's largest memory [bytes].
        faults: Each fault: what was raised or how long it took, with the document's begin.
    """

    read: int
    refused: int
    slowest_s: float
    growth_bytes: int
    faults: list[str]


class TooSlow(Exception):
    """Reading a document took too long."""


class _Reading:
    """Counts the documents of a target."""

    def __init__(self, name: str, watch: Watch) -> None:
        self.target = TARGETS[name]
        self.watch = watch
        self.read = self.refused = 0
        self.last = b""
        self.slowest_s = 0.0

    def one(self, document: bytes) -> None:
        """Read one document.

        Raises:
            Exception: Not the error of a wrong document.
        """
        document = self.last = document[: self.target.most_bytes]
        self.watch(document)
        signal.setitimer(signal.ITIMER_VIRTUAL, _KILLED_S)
        began = time.process_time()
        try:
            self.target.read(document)
            self.read += 1
        except IkplanError as error:
            error.to_problem()
            self.refused += 1
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0)
            took_s = time.process_time() - began
            self.slowest_s = max(self.slowest_s, took_s)
        target(took_s, label="processor time")
        if took_s > MOST_S:
            raise TooSlow(f"{took_s:.2f} s for {len(document)} bytes")


def fuzz(
    name: str,
    *,
    first_seed: int = 0,
    seconds: float = 1e9,
    rounds: int = 10**9,
    examples: int = 100,
    watch: Watch = lambda _: None,
    faults: Path | None = None,
) -> Report:
    """Fuzz one target.

    Args:
        name: Name of the target.
        first_seed: Seed of the first round; the same seed draws the same documents.
        seconds: No document is read after this time [s].
        rounds: Largest number of rounds.
        examples: Documents of a round.
        watch: Called with each document before it is read.
        faults: Folder for the documents of faults, each as small as found.
    """
    reading, found = _Reading(name, watch), list[str]()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    documents = reading.target.documents()
    deadline = time.monotonic() + seconds
    for number in range(first_seed, first_seed + rounds):

        @seed(number)
        @settings(
            max_examples=examples,
            deadline=None,
            database=None,
            phases=[Phase.generate, Phase.target, Phase.shrink],
            suppress_health_check=list(HealthCheck),
            report_multiple_bugs=False,
            print_blob=False,
        )
        @given(document=documents)
        def round_(document: bytes) -> None:
            if time.monotonic() < deadline:
                reading.one(document)

        try:
            round_()
        except Exception:  # whatever it is, it is what is looked for
            found.append(f"seed {number}: {traceback.format_exc(limit=-3)}{reading.last[:300]!r}")
            if faults is not None:
                (faults / f"{name}-{number}").write_bytes(reading.last)
        if time.monotonic() > deadline or len(found) >= _MOST_FAULTS:
            break
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    return Report(reading.read, reading.refused, reading.slowest_s, 1024 * grown, found)
