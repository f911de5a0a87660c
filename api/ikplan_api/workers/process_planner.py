"""The service's planner: warm worker processes and a bounded queue."""

from __future__ import annotations

import asyncio
import logging
import math
import time

from ikplan.errors import BudgetExceeded, MemoryExceeded, ServiceUnavailable
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan.planning import Progress
from ikplan.processor_time import WALL_FACTOR
from ikplan.time_budget import ran_out
from ikplan.workers.process import TaskNotStarted
from ikplan_api.telemetry.load import Load
from ikplan_api.workers import tasks
from ikplan_api.workers.attempts import Attempts
from ikplan_api.workers.tasks import TaskInput, TaskResult
from ikplan_api.workers.worker import TaskLimits
from ikplan_api.workers.worker_slot import (
    TaskTimeout,
    WorkerOutOfMemory,
    WorkerSlot,
)

__all__ = ["ProcessPlanner"]

_log = logging.getLogger("ikplan.service")

LIMIT_S = 60.0
"""Time limit of a task without a time budget [s]."""
_RETRY_AFTER_S = 1.0
_MOST_RETRY_S = 60.0
"""Longest ``Retry-After`` of a refused client [s]."""
_STOPPING_RETRY_S = 5.0
"""Time after which a service that stops may have been replaced [s]."""
_SHARE = 0.1
"""Share of the latest task in the mean duration of tasks."""
_STARTS = 3
"""Workers that may end before they start a task."""


class ProcessPlanner:
    """Runs tasks in warm worker processes behind a bounded queue.

    A task that takes too long, needs too much memory, crashes or is cancelled ends its worker,
    which is replaced; other tasks are not affected. A task whose worker ends otherwise is tried
    once more, after those that wait.

    Args:
        workers: Number of worker processes.
        max_queued: Tasks that may wait for a worker; further tasks are refused.
        memory_bytes: Private memory that a worker may allocate [bytes]; 0: no limit.
        grace_s: Time beyond its limits in which a task may end by itself [s].
        max_wait_s: Longest time that a task waits for a worker, unless it is to wait [s].
    """

    def __init__(
        self,
        workers: int,
        max_queued: int,
        *,
        memory_bytes: int = 0,
        grace_s: float = 1.0,
        max_wait_s: float = math.inf,
    ) -> None:
        self._workers = workers
        self._capacity = workers + max_queued
        self._memory_bytes = memory_bytes
        self._grace_s = grace_s
        self._max_wait_s = max_wait_s
        self._mean_s = 0.0  # of the latest tasks
        self._pending = 0
        self._running = 0
        self._slots: list[WorkerSlot] = []
        self._idle: asyncio.Queue[WorkerSlot | None] = asyncio.Queue()
        self._filling: set[asyncio.Task[None]] = set()
        self._warming: asyncio.Task[None] | None = None
        self._ready = False
        self._closed = False

    @property
    def ready(self) -> bool:
        """Whether the workers are warm and at least one of them runs."""
        alive = len(self._filling) < self._workers
        return self._ready and alive and not self._closed

    @property
    def load(self) -> Load:
        """Current load of the workers."""
        queued = self._pending - self._running
        free = self._workers - self._running - len(self._filling) - queued
        # Where no worker is free, those in front have their turns first.
        wait_s = 0.0 if free > 0 else self._mean_s * (queued + 1) / self._workers
        return Load(self._workers, self._running, queued, wait_s)

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
        known: KnownRequest = UNKNOWN,
        limit_s: float = LIMIT_S,
        progress: Progress | None = None,
        wait_if_full: bool = False,
        attempts: Attempts | None = None,
    ) -> TaskResult:
        """Run one task; see :meth:`ikplan_api.workers.planner.Planner.run`."""
        if not wait_if_full:
            self.check_capacity()
        if self._closed:
            raise _stopping()
        self._pending += 1
        try:
            await self.warm_up()
            # What is parsed travels in the place of the document.
            task = TaskInput(document if known.request is None else b"", robot, known)
            wait_s = math.inf if wait_if_full else self._max_wait_s
            latest, counted = _TaskProgress(progress), attempts or Attempts()
            return await counted.run(
                lambda: self._run_on_worker(kind, task, limit_s, latest, wait_s, counted)
            )
        finally:
            self._pending -= 1

    def check_capacity(self) -> None:
        """Raise if the queue is full; see :class:`~ikplan_api.workers.planner.Planner`."""
        if self._pending >= self._capacity:
            raise self._busy(f"all workers are busy and {self._pending} requests are in progress")

    def _busy(self, why: str) -> ServiceUnavailable:
        """Return the refusal that says when a worker may be free."""
        retry_s = min(_MOST_RETRY_S, max(_RETRY_AFTER_S, math.ceil(self.load.wait_s)))
        return ServiceUnavailable(
            f"{why}; try again in {retry_s:g} s",
            status_code=ServiceUnavailable.status,
            retry_after_s=float(retry_s),
        )

    async def _free_slot(self, wait_s: float) -> WorkerSlot | None:
        """Return the next free slot, or None if the service stops.

        Raises:
            ServiceUnavailable: None is free in time.
        """
        try:
            async with asyncio.timeout(wait_s if math.isfinite(wait_s) else None):
                return await self._idle.get()
        except TimeoutError as error:
            raise self._busy(f"no worker was free within {wait_s:g} s") from error

    async def _run_on_worker(
        self,
        kind: str,
        task: TaskInput,
        limit_s: float,
        task_progress: _TaskProgress,
        wait_s: float,
        attempts: Attempts,
    ) -> TaskResult:
        limits = TaskLimits(limit_s + self._grace_s, WALL_FACTOR * limit_s + self._grace_s)
        for _ in range(_STARTS):
            slot = await self._free_slot(wait_s)
            if slot is None:
                self._idle.put_nowait(None)  # for the next waiting task
                raise _stopping()
            self._running += 1
            began = time.monotonic()
            attempts.begin()
            try:
                return await slot.run(kind, task, limits, task_progress)
            except TaskNotStarted:
                attempts.withdraw()
                continue
            except asyncio.CancelledError:
                attempts.withdraw()
                raise
            except TaskTimeout as error:
                stage = task_progress.stage
                raise BudgetExceeded(
                    f"{ran_out(limit_s, stage, by_processor=error.by_processor)}, and the planner "
                    "was stopped; try a larger budget_s, fewer waypoints or a faster ik.method",
                    stage=stage,
                    budget_s=limit_s,
                ) from error
            except WorkerOutOfMemory as error:
                raise MemoryExceeded(
                    f"the stage {task_progress.stage!r} needed more than the {self._memory_bytes} "
                    "bytes of memory allowed for one request; try fewer waypoints or samples",
                    stage=task_progress.stage,
                    limit_bytes=self._memory_bytes,
                ) from error
            finally:
                self._running -= 1
                took_s = time.monotonic() - began
                self._mean_s += (took_s - self._mean_s) * (_SHARE if self._mean_s else 1.0)
                self._release(slot)
        raise ServiceUnavailable(
            "the workers are being replaced",
            status_code=ServiceUnavailable.status,
            retry_after_s=_RETRY_AFTER_S,
        )

    def _release(self, slot: WorkerSlot) -> None:
        if slot.healthy:
            self._idle.put_nowait(slot)
        elif not self._closed:
            filling = asyncio.create_task(self._refill(slot))
            self._filling.add(filling)
            filling.add_done_callback(self._filling.discard)

    async def _refill(self, slot: WorkerSlot) -> None:
        """Start a new worker in a slot, and retry until it runs."""
        while not self._closed:
            try:
                await slot.fill()
            except Exception:  # the cause may be temporary
                _log.exception("failed to start a worker")
                await asyncio.sleep(_RETRY_AFTER_S)
            else:
                self._idle.put_nowait(slot)
                return

    async def warm_up(self) -> None:
        """Start the workers; return when each can start a task at once."""
        if self._ready:
            return
        if self._warming is None:
            self._warming = asyncio.create_task(self._warm_up())
        await asyncio.shield(self._warming)

    async def _warm_up(self) -> None:
        self._slots = [WorkerSlot(self._memory_bytes) for _ in range(self._workers)]
        # This process itself lists and describes the robots.
        await asyncio.gather(
            asyncio.to_thread(tasks.robots_document), *(slot.fill() for slot in self._slots)
        )
        for slot in self._slots:
            self._idle.put_nowait(slot)
        self._ready = True
        _log.info("ready")

    async def close(self) -> None:
        """Stop the workers and cancel their tasks."""
        self._closed = True
        self._idle.put_nowait(None)
        if self._warming is not None:
            # Even after a failure: workers that it started must be stopped.
            await asyncio.wait([self._warming])
        for filling in list(self._filling):
            await asyncio.wait([filling])
        await asyncio.gather(*(slot.empty() for slot in self._slots))


def _stopping() -> ServiceUnavailable:
    return ServiceUnavailable(
        "the service is stopping",
        status_code=ServiceUnavailable.status,
        retry_after_s=_STOPPING_RETRY_S,
    )


class _TaskProgress:
    """Latest stage of a task; passes its progress on."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self.stage = ""

    def __call__(self, stage: str, done: int, total: int) -> None:
        self.stage = stage
        if self._progress is not None:
            self._progress(stage, done, total)
