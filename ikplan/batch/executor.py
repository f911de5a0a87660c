"""Who answers the chunks of a batch: the interface, and what executors with workers share."""

from __future__ import annotations

import logging
import queue
from collections import deque
from collections.abc import Generator, Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import NamedTuple, Protocol

from ikplan.batch.chunks import Chunk, Done
from ikplan.batch.outcome import Outcome, failed
from ikplan.errors import WorkerLost

__all__ = ["Answers", "BatchWorker", "Executor", "Work", "run_on", "supervised"]

_log = logging.getLogger("ikplan.batch")

_AHEAD = 4
"""Chunks for each worker that are under way or wait for one before them."""


class Answers(NamedTuple):
    """What a worker answers to some lines.

    Attributes:
        outcomes: One for each line, in their order.
        seconds: Time that they took [s].
        faults: Tracebacks of unexpected failures.
    """

    outcomes: list[Outcome]
    seconds: float
    faults: tuple[str, ...] = ()


class Work(Protocol):
    """What is done with lines; it can be pickled."""

    @property
    def preload(self) -> str:
        """The module to import in the process that workers are forked from."""

    def answer(self, lines: Sequence[bytes]) -> Answers:
        """Answer some lines; no line spoils another."""


class Executor(Protocol):
    """Answers chunks of lines."""

    def run(self, chunks: Iterable[Chunk]) -> Generator[Done, None, None]:
        """Answer chunks, in their order.

        No more chunks are taken than a few for each worker: memory does not depend on their
        number. A line that ends its worker costs only itself.

        Args:
            chunks: The chunks; one is taken from there when it is begun.

        Raises:
            ServiceUnavailable: What answers them cannot be reached.
        """

    def close(self) -> None:
        """End the workers, in the middle of what they do."""


class BatchWorker(Protocol):
    """One worker of an executor, which replaces itself when it ends."""

    def answer(self, lines: Sequence[bytes]) -> Answers:
        """Answer some lines.

        Raises:
            WorkerLost: The worker ended in the middle of them.
        """


def run_on(workers: Sequence[BatchWorker], chunks: Iterable[Chunk]) -> Generator[Done, None, None]:
    """Let workers answer chunks, in their order; see :meth:`Executor.run`."""
    idle: queue.SimpleQueue[BatchWorker] = queue.SimpleQueue()
    for worker in workers:
        idle.put(worker)

    def answered(chunk: Chunk) -> Done:
        worker = idle.get()
        try:
            answers = supervised(worker, [line.content for line in chunk.lines])
        finally:
            idle.put(worker)
        for fault in answers.faults:
            _log.error("a request failed: %s", fault)
        return Done(chunk, answers.outcomes, answers.seconds)

    under_way: deque[Future[Done]] = deque()
    with ThreadPoolExecutor(len(workers)) as threads:
        try:
            for chunk in chunks:
                under_way.append(threads.submit(answered, chunk))
                while under_way and (
                    len(under_way) >= _AHEAD * len(workers) or under_way[0].done()
                ):
                    yield under_way.popleft().result()
            while under_way:
                yield under_way.popleft().result()
        finally:
            for future in under_way:
                future.cancel()


def supervised(worker: BatchWorker, lines: Sequence[bytes]) -> Answers:
    """Answer lines; those of a worker that ended are tried again, one by one, once."""
    try:
        return worker.answer(lines)
    except WorkerLost:
        outcomes: list[Outcome] = []
        seconds = 0.0
        faults: list[str] = []
        for line in lines:
            try:
                answers = worker.answer([line])
            except WorkerLost as error:
                outcomes.append(failed(error))
            else:
                outcomes += answers.outcomes
                seconds += answers.seconds
                faults += answers.faults
        return Answers(outcomes, seconds, tuple(faults))
