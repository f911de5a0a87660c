"""One worker process, for a batch and for the service: started, given tasks, replaced, stopped."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable
from typing import Any, TypeVar

from pebble import ProcessExpired, ProcessFuture, ProcessPool

from ikplan.errors import WorkerLost

__all__ = ["TaskNotStarted", "WorkerProcess", "worker_lost"]

T = TypeVar("T")


class TaskNotStarted(Exception):
    """The process ended or was stopped before it had an answer: another one can run the task."""


class WorkerProcess:
    """A process that does one task at a time, and is replaced when it ended in one.

    A process pool of size one: the workers of a larger pool share pipes and locks, and a worker
    killed while it holds them blocks the others. Processes are forked from one that has loaded
    every kernel, so that a replacement takes milliseconds.

    Args:
        preload: The module that the process imports from which workers are forked.
        initializer: Sets up each new worker.
    """

    def __init__(self, preload: str, initializer: Callable[..., object]) -> None:
        self._preload = preload
        self._initializer = initializer
        self._pool: ProcessPool | None = None
        self._doing: ProcessFuture[Any] | None = None

    @property
    def active(self) -> bool:
        """Whether the process takes tasks."""
        return self._pool is not None and self._pool.active

    def start(self, *arguments: object) -> None:
        """Start a new process, in the place of the one before.

        Args:
            arguments: Arguments of the initializer.
        """
        self.stop()
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(["ikplan.workers.single_threaded", self._preload])
        self._pool = ProcessPool(
            1, initializer=self._initializer, initargs=arguments, context=context
        )

    def begin(
        self, function: Callable[..., T], *arguments: object, timeout_s: float | None = None
    ) -> ProcessFuture[T]:
        """Begin a task.

        Args:
            function: The task.
            arguments: Its arguments.
            timeout_s: The process is killed when the task takes longer [s]; None: no limit.

        Returns:
            What will come of it: the result, what the task raised, ProcessExpired where the
            process ended in it, TimeoutError, or TaskNotStarted.

        Raises:
            TaskNotStarted: The process had ended before.
        """
        if self._pool is None:
            raise TaskNotStarted
        try:
            self._doing = self._pool.schedule(function, args=arguments, timeout=timeout_s)
        except RuntimeError as error:  # raised by pebble for a pool that lost its worker
            raise TaskNotStarted from error
        return self._doing

    def stop(self) -> None:
        """End the process, even in the midst of a task."""
        if self._pool is not None:
            self._pool.stop()  # type: ignore[no-untyped-call]
            self._pool.join()
            self._pool = None
        if self._doing is not None and not self._doing.done():
            self._doing.set_exception(TaskNotStarted())  # pebble leaves it open


def worker_lost(error: ProcessExpired) -> WorkerLost:
    """Return the error of a task whose process ended in the midst of it."""
    code = int(error.exitcode)
    how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
    return WorkerLost(
        f"the worker process ended {how}; other requests are not affected", exit_code=code
    )
