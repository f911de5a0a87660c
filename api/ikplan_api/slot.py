"""A place for one worker: always filled again, whatever becomes of who works there."""

from __future__ import annotations

import asyncio
import multiprocessing
import signal
import socket

from pebble import ProcessExpired, ProcessFuture, ProcessPool

from ikplan.errors import IkplanError, WorkerLost
from ikplan_api import handover, worker
from ikplan_api.tasks import Answer

__all__ = ["NotBegun", "Overdue", "WorkerSlot"]

_FORKING = multiprocessing.get_context("forkserver")
_FORKING.set_forkserver_preload(["ikplan.single_threaded", "ikplan_api.preload"])
_GRACE_S = 5.0
_LONG = 4 * 2**20
"""Length of a document that takes milliseconds to copy [bytes]."""


class NotBegun(Exception):
    """The worker was gone before it took the task, or is none any more: another one can do it."""


class Overdue(Exception):
    """The worker was ended because the task took too long."""


class OutOfMemory(Exception):
    """The worker ended because the task needed too much memory."""


class WorkerSlot:
    """One worker process, replaced whenever it ends or has to be ended.

    A pool of one: the workers of a larger pool share pipes and locks, and one that is killed
    while it holds them takes the others with it. New workers are forked from a process that has
    every kernel and robot loaded, so that a replacement costs milliseconds.

    Args:
        memory_bytes: Most memory of its own that the worker may take [bytes]; 0: no limit.
        reports: Where the worker tells its progress.
    """

    def __init__(self, memory_bytes: int, reports: socket.socket) -> None:
        self._initial = (memory_bytes, reports)
        self._pool: ProcessPool | None = None
        self._documents: tuple[socket.socket, socket.socket] | None = None
        self._doing: ProcessFuture[worker.Done] | None = None
        self.pid = 0
        self.healthy = False

    async def fill(self) -> None:
        """Put a new worker here, ended the one before; returns when it can be given a task.

        Raises:
            Exception: What kept it from getting ready.
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
        """End the worker, in the middle of what it does."""
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
            self._doing.set_exception(NotBegun())  # pebble leaves it open

    async def run(
        self, task: int, kind: str, document: bytes, robot: bytes | None, limit_s: float
    ) -> Answer:
        """Let the worker do a task; unless it stays healthy, it has to be filled again.

        Raises:
            IkplanError: The verdict on the request.
            NotBegun: The worker was gone before.
            Overdue: The task took too long.
            OutOfMemory: The task needed too much memory.
            WorkerLost: The worker ended in the middle of the task.
        """
        assert self._pool is not None
        self.healthy = False
        try:
            self._doing = self._pool.schedule(
                worker.do,
                args=(task, kind, document, robot, limit_s),
                # The worker keeps the time itself; this is for one that has been halted.
                timeout=worker.READY_S + limit_s + _GRACE_S,
            )
            done = await asyncio.wrap_future(self._doing)
        except (IkplanError, worker.TaskFault):
            self.healthy = True
            raise
        except ProcessExpired as error:
            raise _loss(error) from error
        except TimeoutError as error:
            raise Overdue from error
        except RuntimeError as error:  # pebble's, of a pool that has lost its worker
            raise NotBegun from error
        answer = done.answer
        if done.handed_over:
            answer = answer._replace(document=await self._document(done.handed_over))
        self.healthy = True
        return answer

    async def _document(self, length: int) -> bytes:
        """Take the document that the worker has handed over."""
        assert self._documents is not None
        here, _ = self._documents
        if length > _LONG:
            return await asyncio.to_thread(handover.receive, here)
        return handover.receive(here)


def _loss(error: ProcessExpired) -> Exception:
    """What the exit code of a worker says."""
    code = int(error.exitcode)
    if code == -signal.SIGALRM:
        return Overdue()
    if code == worker.OUT_OF_MEMORY:
        return OutOfMemory()
    how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
    return WorkerLost(
        f"the process that did the work was ended {how}; nothing else was affected", exit_code=code
    )
