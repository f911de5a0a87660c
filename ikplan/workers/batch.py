"""Many requests, planned here: by as many processes as there are processors."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
from collections import deque
from collections.abc import Generator, Iterable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from typing import TYPE_CHECKING

from pebble import ProcessExpired

from ikplan.errors import IkplanError
from ikplan.workers import batch_worker as worker
from ikplan.workers.child import Fault
from ikplan.workers.process import TaskNotStarted, WorkerProcess, worker_lost
from ikplan.workers.processors import processor_count

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["plan_lines"]

_log = logging.getLogger("ikplan.workers")

_ATTEMPTS = 3


def plan_lines(
    lines: Iterable[bytes], *, workers: int = 0, robot: Robot | None = None
) -> Generator[bytes | IkplanError, None, None]:
    """Plan the lines of a batch.

    Args:
        lines: The requests, each JSON.
        workers: How many are planned at the same time; 0: one a processor.
        robot: The robot of all of them; None: the one that each names.

    Yields:
        For each line, in their order and as soon as it is known, the plan, JSON, or the error
        that :func:`ikplan.plan` would have raised; WorkerLost for one that took its process with
        it. No line spoils another.
    """
    count = workers or processor_count()
    crew = [_Worker(robot) for _ in range(count)]
    idle: queue.SimpleQueue[_Worker] = queue.SimpleQueue()
    for one in crew:
        idle.put(one)

    def answer(line: bytes) -> bytes | IkplanError:
        one = idle.get()
        try:
            return one.answer(line)
        finally:
            idle.put(one)

    under_way: deque[Future[bytes | IkplanError]] = deque()
    with ThreadPoolExecutor(count) as threads:
        try:
            for line in lines:
                under_way.append(threads.submit(answer, line))
                # Answers that wait for one before them take memory.
                if len(under_way) >= 2 * count:
                    yield under_way.popleft().result()
            while under_way:
                yield under_way.popleft().result()
        finally:
            for future in under_way:
                future.cancel()
            for one in crew:
                one.stop()


class _Worker:
    """One process, replaced when it ends in the middle of a plan."""

    def __init__(self, robot: Robot | None) -> None:
        self._robot = robot
        self._process = WorkerProcess("ikplan.workers.preload", worker.begin)
        self._stopped = False
        self._changing = threading.Lock()

    def answer(self, line: bytes) -> bytes | IkplanError:
        try:
            return self._result(line)
        except IkplanError as error:
            return error
        except ProcessExpired as error:
            return worker_lost(error)
        except Fault as fault:
            _log.error("a request failed: %s", fault)
            return IkplanError("an unexpected fault of ikplan, told on stderr")

    def _result(self, line: bytes) -> bytes:
        for _ in range(_ATTEMPTS - 1):
            with contextlib.suppress(TaskNotStarted):  # it ended while it had nothing to do
                return self._begin(line).result()
        return self._begin(line).result()

    def _begin(self, line: bytes) -> Future[bytes]:
        with self._changing:
            if self._stopped:
                raise CancelledError
            if not self._process.active:
                self._process.start(self._robot)
            return self._process.begin(worker.make, line)

    def stop(self) -> None:
        """End the process, in the middle of what it does."""
        with self._changing:
            self._stopped = True
            self._process.stop()
