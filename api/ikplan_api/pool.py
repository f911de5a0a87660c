"""The planner of the service: a warm worker process for each processor, a queue before them."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import logging
import socket

from ikplan.errors import BudgetExceeded, MemoryExceeded, ServiceUnavailable
from ikplan.planning import Progress
from ikplan_api import tasks
from ikplan_api.planner import Load
from ikplan_api.slot import NotBegun, OutOfMemory, Overdue, WorkerSlot
from ikplan_api.tasks import Answer

__all__ = ["ProcessPlanner"]

_log = logging.getLogger("ikplan.service")

LIMIT_S = 60.0
"""Longest time that a task without a budget of its own may take [s]."""
_RETRY_AFTER_S = 1.0
_ATTEMPTS = 3


class ProcessPlanner:
    """Warm worker processes and a bounded queue before them.

    A task that takes too long, needs too much memory, crashes or is no longer wanted costs its
    worker, which is replaced, and nothing else.

    Args:
        workers: Tasks done at the same time.
        max_queued: Tasks that may wait; more are refused.
        memory_bytes: Most memory of its own that a worker may take [bytes]; 0: no limit.
        grace_s: How much longer than its limit a task may take to end by itself [s].
    """

    def __init__(
        self, workers: int, max_queued: int, *, memory_bytes: int = 0, grace_s: float = 1.0
    ) -> None:
        self._workers = workers
        self._room = workers + max_queued
        self._memory_bytes = memory_bytes
        self._grace_s = grace_s
        self._taken = 0
        self._running = 0
        self._numbers = itertools.count()
        self._told: dict[int, _Told] = {}
        self._slots: list[WorkerSlot] = []
        self._idle: asyncio.Queue[WorkerSlot | None] = asyncio.Queue()
        self._filling: set[asyncio.Task[None]] = set()
        self._warming: asyncio.Task[None] | None = None
        self._reports: tuple[socket.socket, socket.socket] | None = None
        self._ready = False
        self._closed = False

    @property
    def ready(self) -> bool:
        """Whether the workers are warm, and at least one of them is there."""
        alive = len(self._filling) < self._workers
        return self._ready and alive and not self._closed

    @property
    def load(self) -> Load:
        """What the workers have to do."""
        return Load(self._workers, self._running, self._taken - self._running)

    @property
    def pids(self) -> list[int]:
        """Process ids of the workers."""
        return [slot.pid for slot in self._slots]

    async def run(
        self,
        kind: str,
        document: bytes,
        *,
        robot: bytes | None = None,
        limit_s: float = LIMIT_S,
        progress: Progress | None = None,
        patient: bool = False,
    ) -> Answer:
        """Do one task; see :meth:`ikplan_api.planner.Planner.run`."""
        if not patient:
            self.check_room()
        if self._closed:
            raise _stopping()
        self._taken += 1
        try:
            await self.warm_up()
            return await self._done(kind, document, robot, limit_s, _Told(progress))
        finally:
            self._taken -= 1

    def check_room(self) -> None:
        """Do nothing where one more task may wait; see :class:`~ikplan_api.planner.Planner`."""
        if self._taken >= self._room:
            raise ServiceUnavailable(
                f"all workers are busy and {self._taken} requests are under way; "
                f"try again in {_RETRY_AFTER_S:g} s",
                status_code=ServiceUnavailable.status,
                retry_after_s=_RETRY_AFTER_S,
            )

    async def _done(
        self, kind: str, document: bytes, robot: bytes | None, limit_s: float, told: _Told
    ) -> Answer:
        for _ in range(_ATTEMPTS):
            slot = await self._idle.get()
            if slot is None:
                self._idle.put_nowait(None)  # for the next who waits
                raise _stopping()
            task = next(self._numbers)
            self._told[task] = told
            self._running += 1
            try:
                return await slot.run(task, kind, document, robot, limit_s + self._grace_s)
            except NotBegun:
                continue
            except Overdue as error:
                raise BudgetExceeded(
                    f"the budget of {limit_s:g} s ran out in the stage {told.stage!r}, and the "
                    "work was stopped; a larger budget_s, fewer waypoints or a faster ik.method "
                    "would help",
                    stage=told.stage,
                    budget_s=limit_s,
                ) from error
            except OutOfMemory as error:
                raise MemoryExceeded(
                    f"the stage {told.stage!r} needed more than the {self._memory_bytes} bytes of "
                    "memory that one request may take; fewer waypoints or samples would help",
                    stage=told.stage,
                    limit_bytes=self._memory_bytes,
                ) from error
            finally:
                self._running -= 1
                del self._told[task]
                self._give_back(slot)
        raise ServiceUnavailable(
            "the workers are being replaced",
            status_code=ServiceUnavailable.status,
            retry_after_s=_RETRY_AFTER_S,
        )

    def _give_back(self, slot: WorkerSlot) -> None:
        if slot.healthy:
            self._idle.put_nowait(slot)
        elif not self._closed:
            filling = asyncio.create_task(self._refill(slot))
            self._filling.add(filling)
            filling.add_done_callback(self._filling.discard)

    async def _refill(self, slot: WorkerSlot) -> None:
        """Replace a worker, however often it takes: a service without workers is none."""
        while not self._closed:
            try:
                await slot.fill()
            except Exception:  # whatever keeps a process from starting may pass
                _log.exception("a worker could not be started")
                await asyncio.sleep(_RETRY_AFTER_S)
            else:
                self._idle.put_nowait(slot)
                return

    async def warm_up(self) -> None:
        """Start the workers; returns when each can begin a task at once."""
        if self._ready:
            return
        if self._warming is None:
            self._warming = asyncio.create_task(self._warm_up())
        await asyncio.shield(self._warming)

    async def _warm_up(self) -> None:
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        here.setblocking(False)
        self._reports = here, there
        asyncio.get_running_loop().add_reader(here, self._hear)
        self._slots = [WorkerSlot(self._memory_bytes, there) for _ in range(self._workers)]
        # What lists and describes the robots is answered by this process.
        await asyncio.gather(
            asyncio.to_thread(tasks.robots_document), *(slot.fill() for slot in self._slots)
        )
        for slot in self._slots:
            self._idle.put_nowait(slot)
        self._ready = True
        _log.info("ready")

    def _hear(self) -> None:
        """Pass on what the workers tell."""
        assert self._reports is not None
        with contextlib.suppress(BlockingIOError):
            while True:
                task, stage, done, total = json.loads(self._reports[0].recv(4096))
                if told := self._told.get(task):
                    told(stage, done, total)

    async def close(self) -> None:
        """Stop, and whatever is being done with it."""
        self._closed = True
        self._idle.put_nowait(None)
        if self._warming is not None:
            # Whether it worked or not: what it began has to be ended.
            await asyncio.wait([self._warming])
        for filling in list(self._filling):
            await asyncio.wait([filling])
        await asyncio.gather(*(slot.empty() for slot in self._slots))
        if self._reports is not None:
            asyncio.get_running_loop().remove_reader(self._reports[0])
            for end in self._reports:
                end.close()
            self._reports = None


def _stopping() -> ServiceUnavailable:
    return ServiceUnavailable("the service is stopping", status_code=ServiceUnavailable.status)


class _Told:
    """What is known of a task's progress."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self.stage = ""

    def __call__(self, stage: str, done: int, total: int) -> None:
        self.stage = stage
        if self._progress is not None:
            self._progress(stage, done, total)
