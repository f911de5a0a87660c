"""A slot for one worker process, which is replaced whenever it ends."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import pickle
import signal
import socket

import orjson
from pebble import ProcessExpired, ProcessFuture

from ikplan.errors import IkplanError
from ikplan.planning import Progress
from ikplan.workers.child import Fault
from ikplan.workers.process import TaskNotStarted, WorkerProcess, worker_lost
from ikplan_api.workers import worker
from ikplan_api.workers.shared_memory import DocumentReceiver
from ikplan_api.workers.task_line import TaskLine
from ikplan_api.workers.tasks import TaskInput, TaskResult

__all__ = ["TaskTimeout", "WorkerOutOfMemory", "WorkerSlot"]

_GRACE_S = 5.0
_EVERY_S = 0.05
"""Time between two looks at the progress of a task [s]."""
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
    """

    def __init__(self, memory_bytes: int) -> None:
        self._memory_bytes = memory_bytes
        self._process = WorkerProcess("ikplan_api.workers.preload", worker.initialize)
        self._line: TaskLine | None = None
        self._reports: tuple[socket.socket, ...] = ()
        self._documents: DocumentReceiver | None = None
        self._numbers = itertools.count(1)
        self._lost: BaseException | None = None
        self.pid = 0
        self.healthy = False

    async def fill(self) -> None:
        """Replace the worker by a new one; return when it is ready for a task.

        Raises:
            Exception: The new worker failed to start.
        """
        await self.empty()
        loop = asyncio.get_running_loop()
        self._lost = None
        self._line = line = TaskLine()
        self._documents = documents = DocumentReceiver()
        self._reports = _pair()
        serving = await asyncio.to_thread(self._start, line, documents.there)

        def ended(_: object) -> None:
            error = serving.exception() or TaskNotStarted()
            with contextlib.suppress(RuntimeError):  # the loop is closed
                loop.call_soon_threadsafe(self._end, line, error)

        serving.add_done_callback(ended)
        self.healthy = True

    def _start(self, line: TaskLine, documents: socket.socket) -> ProcessFuture[None]:
        self._process.start(self._memory_bytes, self._reports[1], documents)
        self.pid = self._process.begin(worker.ready).result()
        return self._process.begin(worker.serve, line.there)

    def _end(self, line: TaskLine, error: BaseException) -> None:
        """Learn that a worker ended, in a task or not."""
        line.give_up(error)
        if line is self._line:
            self._lost = error

    async def empty(self) -> None:
        """End the worker, even during a task."""
        self.healthy = False
        await asyncio.to_thread(self._process.stop)
        for kept in (self._line, self._documents, *self._reports):
            if kept is not None:
                kept.close()
        self._line, self._documents, self._reports = None, None, ()

    async def run(
        self, kind: str, task: TaskInput, limits: worker.TaskLimits, progress: Progress
    ) -> TaskResult:
        """Run a task on the worker; if ``healthy`` is false afterwards, call ``fill``.

        Args:
            kind: Name of the task.
            task: Its input.
            limits: Time in which it must end.
            progress: Receives its progress.

        Raises:
            IkplanError: The verdict on the request.
            TaskNotStarted: The worker ended before the task started.
            TaskTimeout: The task took too long.
            WorkerOutOfMemory: The task needed too much memory.
            WorkerLost: The worker ended during the task.
        """
        self.healthy = False
        if self._line is None or self._lost is not None:
            raise TaskNotStarted
        reading = _Reading(next(self._numbers), self._reports[0], progress)
        message = pickle.dumps((kind, task, limits), pickle.HIGHEST_PROTOCOL)
        try:
            # The worker has timers of its own; the longer limit is for a halted process.
            async with asyncio.timeout(worker.READY_S + limits.wall_s + _GRACE_S):
                reply = pickle.loads(await self._line.ask(reading.number, message))
        except ProcessExpired as error:
            reading.read()
            raise (_loss(error) if reading.begun else TaskNotStarted()) from error
        except TimeoutError as error:
            raise TaskTimeout(by_processor=False) from error
        except (RuntimeError, OSError) as error:  # a pool that lost its worker
            raise TaskNotStarted from error
        finally:
            reading.end()
        if isinstance(reply, Exception):
            self.healthy = isinstance(reply, IkplanError | Fault)
            raise reply
        result: TaskResult = reply.result
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
        if length > _LONG:
            return await asyncio.to_thread(self._documents.receive, length)
        return self._documents.receive(length)


class _Reading:
    """Reads the progress reports of one task, now and then: no report wakes the service.

    Args:
        number: Number of the task.
        reports: Where its reports are.
        progress: Receives them.

    Attributes:
        begun: Whether the task has arrived at its worker.
    """

    def __init__(self, number: int, reports: socket.socket, progress: Progress) -> None:
        self.number = number
        self.begun = False
        self._reports = reports
        self._progress = progress
        self._loop = asyncio.get_running_loop()
        self._timer = self._loop.call_later(_EVERY_S, self._again)

    def _again(self) -> None:
        self.read()
        self._timer = self._loop.call_later(_EVERY_S, self._again)

    def read(self) -> None:
        """Pass on what has been reported."""
        with contextlib.suppress(OSError):  # there is no more
            while True:
                task, stage, done, total = orjson.loads(self._reports.recv(4096))
                if task == self.number:
                    self.begun = True
                    if stage:
                        self._progress(stage, done, total)

    def end(self) -> None:
        """Read the last reports."""
        self._timer.cancel()
        self.read()


def _pair() -> tuple[socket.socket, socket.socket]:
    """Return a pair of sockets for reports; reading from the first does not block."""
    here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    here.setblocking(False)
    return here, there


def _loss(error: ProcessExpired) -> Exception:
    """Return the error for a worker's exit code."""
    code = int(error.exitcode)
    if code in (-signal.SIGALRM, -signal.SIGPROF):
        return TaskTimeout(by_processor=code == -signal.SIGPROF)
    if code == worker.OUT_OF_MEMORY:
        return WorkerOutOfMemory()
    return worker_lost(error)
