"""Chunks answered here, by as many processes as there are processors."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Generator, Iterable, Sequence
from concurrent.futures import CancelledError

from pebble import ProcessExpired, ProcessFuture

from ikplan.batch.chunks import Chunk, Done
from ikplan.batch.executor import Answers, Work, run_on
from ikplan.workers.child import set_up
from ikplan.workers.process import TaskNotStarted, WorkerProcess, worker_lost
from ikplan.workers.processors import processor_count

__all__ = ["LocalExecutor", "LocalWorker"]

_ATTEMPTS = 3

_work: list[Work] = []


class LocalExecutor:
    """Worker processes of this machine, forked warm.

    Args:
        work: What is done with the lines.
        workers: How many processes; 0: one a processor.
    """

    def __init__(self, work: Work, workers: int = 0) -> None:
        self._workers = [LocalWorker(work) for _ in range(workers or processor_count())]

    def run(self, chunks: Iterable[Chunk]) -> Generator[Done, None, None]:
        """Answer chunks, see :meth:`ikplan.batch.executor.Executor.run`."""
        try:
            yield from run_on(self._workers, chunks)
        finally:
            self.close()

    def close(self) -> None:
        """End the processes, in the middle of what they do."""
        for worker in self._workers:
            worker.stop()


class LocalWorker:
    """One process, replaced when it ends.

    Args:
        work: What is done with the lines.
    """

    def __init__(self, work: Work) -> None:
        self._work = work
        self._process = WorkerProcess(work.preload, _begin)
        self._stopped = False
        self._changing = threading.Lock()

    def answer(self, lines: Sequence[bytes]) -> Answers:
        """Answer some lines.

        Raises:
            WorkerLost: The process ended in the middle of them.
        """
        try:
            for _ in range(_ATTEMPTS - 1):
                with contextlib.suppress(TaskNotStarted):  # it ended while it had nothing to do
                    return self._start(lines).result()
            return self._start(lines).result()
        except ProcessExpired as error:
            raise worker_lost(error) from error

    def _start(self, lines: Sequence[bytes]) -> ProcessFuture[Answers]:
        with self._changing:
            if self._stopped:
                raise CancelledError
            if not self._process.active:
                self._process.start(self._work)
            return self._process.begin(_answer, list(lines))

    def stop(self) -> None:
        """End the process, in the middle of what it does."""
        with self._changing:
            self._stopped = True
            self._process.stop()


def _begin(work: Work) -> None:
    """Set a worker process up."""
    _work[:] = [work]
    set_up()


def _answer(lines: list[bytes]) -> Answers:
    """Answer lines, in a worker process."""
    return _work[0].answer(lines)
