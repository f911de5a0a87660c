"""A slot for one worker process, which is replaced whenever it ends."""

from __future__ import annotations

import asyncio
import signal
import socket

from pebble import ProcessExpired

from ikplan.errors import IkplanError
from ikplan.workers.child import Fault
from ikplan.workers.process import TaskNotStarted, WorkerProcess, worker_lost
from ikplan_api.workers import shared_memory, worker
from ikplan_api.workers.tasks import TaskInput, TaskResult

__all__ = ["TaskTimeout", "WorkerOutOfMemory", "WorkerSlot"]

_GRACE_S = 5.0
_LONG = 4 * 2**20
"""Length from which copying a document takes milliseconds [bytes]."""


class TaskTimeout(Exception):
    """The worker was killed because the task took too long.

    Args:
        by_processor: Whether its processor time ran out, not its wall time.
    """

    def __init__(self, *, by_processor: bool) -> None:
        super().__init__()
        self.by_processor = by_processor


class WorkerOutOfMemory(Exception):
    """The worker ended because the task needed too much memory."""


class WorkerSlot:
    """One worker process of the service, replaced whenever it ends.

    Args:
        memory_bytes: Private memory that the worker may allocate [bytes]; 0: no limit.
        reports: Socket for the worker's progress reports.
    """

    def __init__(self, memory_bytes: int, reports: socket.socket) -> None:
        self._initial = (memory_bytes, reports)
        self._process = WorkerProcess("ikplan_api.workers.preload", worker.initialize)
        self._documents: tuple[socket.socket, socket.socket] | None = None
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
        self._process.start(*self._initial, there)
        self.pid = self._process.begin(worker.ready).result()
        self.healthy = True

    async def empty(self) -> None:
        """End the worker, even during a task."""
        await asyncio.to_thread(self._empty)

    def _empty(self) -> None:
        self.healthy = False
        self._process.stop()
        for end in self._documents or ():
            end.close()
        self._documents = None

    async def run(
        self, number: int, kind: str, task: TaskInput, limits: worker.TaskLimits
    ) -> TaskResult:
        """Run a task on the worker; if ``healthy`` is false afterwards, call ``fill``.

        Raises:
            IkplanError: The verdict on the request.
            TaskNotStarted: The worker ended before the task started.
            TaskTimeout: The task took too long.
            WorkerOutOfMemory: The task needed too much memory.
            WorkerLost: The worker ended during the task.
        """
        self.healthy = False
        try:
            # The worker has timers of its own; the longer limit is for a halted process.
            patience_s = worker.READY_S + limits.wall_s + _GRACE_S
            doing = self._process.begin(
                worker.run, number, kind, task, limits, timeout_s=patience_s
            )
            reply = await asyncio.wrap_future(doing)
        except (IkplanError, Fault):
            self.healthy = True
            raise
        except ProcessExpired as error:
            raise _loss(error) from error
        except TimeoutError as error:
            raise TaskTimeout(by_processor=False) from error
        except RuntimeError as error:  # raised by pebble for a pool that lost its worker
            raise TaskNotStarted from error
        result = reply.result
        if reply.shared_bytes:
            try:
                result = result._replace(document=await self._document(reply.shared_bytes))
            except OSError as error:  # the answer is lost: another worker makes it again
                raise TaskNotStarted from error
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
    if code in (-signal.SIGALRM, -signal.SIGPROF):
        return TaskTimeout(by_processor=code == -signal.SIGPROF)
    if code == worker.OUT_OF_MEMORY:
        return WorkerOutOfMemory()
    return worker_lost(error)
