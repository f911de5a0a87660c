"""A slot for one worker process, which is replaced whenever it ends."""

from __future__ import annotations

import asyncio
import multiprocessing
import signal
import socket

from pebble import ProcessExpired, ProcessFuture, ProcessPool

from ikplan.errors import IkplanError, WorkerLost
from ikplan_api.workers import shared_memory, worker
from ikplan_api.workers.tasks import TaskResult

__all__ = ["TaskNotStarted", "TaskTimeout", "WorkerSlot"]

_FORKING = multiprocessing.get_context("forkserver")
_FORKING.set_forkserver_preload(["ikplan.workers.single_threaded", "ikplan_api.workers.preload"])
_GRACE_S = 5.0
_LONG = 4 * 2**20
"""Length from which copying a document takes milliseconds [bytes]."""


class TaskNotStarted(Exception):
    """The worker ended before it started the task: another worker can run it."""


class TaskTimeout(Exception):
    """The worker was killed because the task took too long."""


class WorkerOutOfMemory(Exception):
    """The worker ended because the task needed too much memory."""


class WorkerSlot:
    """One worker process, replaced whenever it ends.

    A process pool of size one: the workers of a larger pool share pipes and locks, and a worker
    killed while it holds them blocks the others. New workers are forked from a process that has
    loaded every kernel and robot, so that a replacement takes milliseconds.

    Args:
        memory_bytes: Private memory that the worker may allocate [bytes]; 0: no limit.
        reports: Socket for the worker's progress reports.
    """

    def __init__(self, memory_bytes: int, reports: socket.socket) -> None:
        self._initial = (memory_bytes, reports)
        self._pool: ProcessPool | None = None
        self._documents: tuple[socket.socket, socket.socket] | None = None
        self._doing: ProcessFuture[worker.WorkerReply] | None = None
        self.pid = 0
        self.healthy = False

    async def fill(self) -> None:
        """Replace the worker by a new one; return when it is ready for a task.

        Raises:
            Exception: The new worker failed to start.
        """
        await asyncio.to_thread(self._fill)

    def _fill(self) -> None:
        self._empty()
        self._documents = here, there = socket.socketpair()
        here.setblocking(False)
        pool = ProcessPool(
            1, initializer=worker.initialize, initargs=(*self._initial, there), context=_FORKING
        )
        self._pool = pool
        self.pid = pool.schedule(worker.ready).result()
        self.healthy = True

    async def empty(self) -> None:
        """End the worker, even during a task."""
        await asyncio.to_thread(self._empty)

    def _empty(self) -> None:
        self.healthy = False
        if self._pool is not None:
            self._pool.stop()  # type: ignore[no-untyped-call]
            self._pool.join()
            self._pool = None
        for end in self._documents or ():
            end.close()
        self._documents = None
        if self._doing is not None and not self._doing.done():
            self._doing.set_exception(TaskNotStarted())  # pebble leaves it open

    async def run(
        self, task: int, kind: str, document: bytes, robot: bytes | None, limit_s: float
    ) -> TaskResult:
        """Run a task on the worker; if ``healthy`` is false afterwards, call ``fill``.

        Raises:
            IkplanError: The verdict on the request.
            TaskNotStarted: The worker ended before the task started.
            TaskTimeout: The task took too long.
            WorkerOutOfMemory: The task needed too much memory.
            WorkerLost: The worker ended during the task.
        """
        assert self._pool is not None
        self.healthy = False
        try:
            self._doing = self._pool.schedule(
                worker.run,
                args=(task, kind, document, robot, limit_s),
                # The worker has a timer of its own; this limit is for a halted process.
                timeout=worker.READY_S + limit_s + _GRACE_S,
            )
            reply = await asyncio.wrap_future(self._doing)
        except (IkplanError, worker.TaskFault):
            self.healthy = True
            raise
        except ProcessExpired as error:
            raise _loss(error) from error
        except TimeoutError as error:
            raise TaskTimeout from error
        except RuntimeError as error:  # raised by pebble for a pool that lost its worker
            raise TaskNotStarted from error
        result = reply.result
        if reply.shared_bytes:
            result = result._replace(document=await self._document(reply.shared_bytes))
        self.healthy = True
        return result

    async def _document(self, length: int) -> bytes:
        """Receive the document that the worker sent."""
        assert self._documents is not None
        here, _ = self._documents
        if length > _LONG:
            return await asyncio.to_thread(shared_memory.receive, here)
        return shared_memory.receive(here)


def _loss(error: ProcessExpired) -> Exception:
    """Return the error for a worker's exit code."""
    code = int(error.exitcode)
    if code == -signal.SIGALRM:
        return TaskTimeout()
    if code == worker.OUT_OF_MEMORY:
        return WorkerOutOfMemory()
    how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
    return WorkerLost(
        f"the worker process ended {how}; other requests are not affected", exit_code=code
    )
