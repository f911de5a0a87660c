"""Who does the work: the event loop never plans."""

from __future__ import annotations

import asyncio
import logging
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Protocol

from ikplan.errors import ServiceUnavailable
from ikplan_api import tasks
from ikplan_api.tasks import Answer

__all__ = ["Planner", "ThreadPlanner"]

_log = logging.getLogger("ikplan.service")

_RETRY_AFTER_S = 1.0


class Planner(Protocol):
    """Runs tasks off the event loop."""

    @property
    def ready(self) -> bool:
        """Whether a request would be answered without waiting for a compiler."""

    async def run(self, kind: str, document: bytes, *, robot: bytes | None = None) -> Answer:
        """Do one task of :data:`ikplan_api.tasks.TASKS`.

        Args:
            kind: Name of the task.
            document: The request document as it came in.
            robot: The upload of the robot that it names; None: it names one of the catalogue.

        Raises:
            IkplanError: The verdict on the request.
            ServiceUnavailable: No room in the queue.
        """

    async def warm_up(self) -> None:
        """Get ready; returns when ``ready`` is true, or raises why it is not."""

    async def close(self) -> None:
        """Stop, after the tasks already begun."""


class ThreadPlanner:
    """A bounded number of threads and a bounded queue before them.

    The kernels release the interpreter lock, robots and kernels are in memory once, and no
    worker has to be started before the first answer. What threads cannot do is stop a task that
    runs away or survive one that crashes the interpreter.

    Args:
        workers: Tasks done at the same time.
        max_queued: Tasks that may wait; more are refused.
    """

    def __init__(self, workers: int, max_queued: int) -> None:
        self._executor = ThreadPoolExecutor(workers, thread_name_prefix="ikplan-worker")
        self._room = workers + max_queued
        self._taken = 0
        self._lock = threading.Lock()
        self._ready = False

    @property
    def ready(self) -> bool:
        """Whether the kernels are compiled and the robots loaded."""
        return self._ready

    async def run(self, kind: str, document: bytes, *, robot: bytes | None = None) -> Answer:
        """Do one task of :data:`ikplan_api.tasks.TASKS`.

        Args:
            kind: Name of the task.
            document: The request document as it came in.
            robot: The upload of the robot that it names; None: it names one of the catalogue.

        Raises:
            IkplanError: The verdict on the request.
            ServiceUnavailable: No room in the queue.
        """
        with self._lock:
            if self._taken >= self._room:
                raise ServiceUnavailable(
                    f"all workers are busy and {self._room} requests are under way; "
                    f"try again in {_RETRY_AFTER_S:g} s",
                    status_code=ServiceUnavailable.status,
                    retry_after_s=_RETRY_AFTER_S,
                )
            self._taken += 1
        try:
            future = self._executor.submit(tasks.run_task, kind, document, robot)
        except RuntimeError as error:  # shut down
            self._release()
            raise ServiceUnavailable(
                "the service is stopping", status_code=ServiceUnavailable.status
            ) from error
        # Not when the caller gives up, but when the thread is free again.
        future.add_done_callback(self._release)
        return await asyncio.wrap_future(future)

    def _release(self, _: Future[Any] | None = None) -> None:
        with self._lock:
            self._taken -= 1

    async def warm_up(self) -> None:
        """Compile or load the kernels and load the robots."""
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._executor, tasks.warm_up)
        self._ready = True
        _log.info("ready")

    async def close(self) -> None:
        """Stop, after the tasks already begun; those that still wait are dropped."""
        await asyncio.to_thread(self._executor.shutdown, wait=True, cancel_futures=True)
