"""Graceful shutdown within a bounded time."""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import AsyncIterator
from typing import TypeVar

from ikplan_api.jobs.job_service import JobService

__all__ = ["Shutdown"]

T = TypeVar("T")

_log = logging.getLogger("ikplan.service")


class Shutdown:
    """Graceful shutdown: closes event streams, drains running plans.

    Args:
        jobs: The plan jobs.
        stop_s: Time for the jobs in progress to finish [s].
    """

    def __init__(self, jobs: JobService, stop_s: float) -> None:
        self._jobs = jobs
        self._stop_s = stop_s
        self._requested = asyncio.Event()
        self._deadline = math.inf

    def begin(self) -> float:
        """Start the shutdown.

        Returns:
            Time for requests in progress to finish [s].
        """
        if not self._requested.is_set():
            self._deadline = time.monotonic() + self._stop_s
            self._requested.set()
            self._jobs.park_queued()
            _log.info("stopping: plans in progress have %g s to finish", self._stop_s)
        return self._stop_s

    async def drain(self) -> None:
        """Wait for the jobs in progress until the deadline."""
        self.begin()
        await self._jobs.drain(max(0.0, self._deadline - time.monotonic()))

    async def until_shutdown(self, source: AsyncIterator[T]) -> AsyncIterator[T]:
        """Yield the items of a source until the shutdown starts."""
        requested = asyncio.ensure_future(self._requested.wait())
        coming: asyncio.Future[T] | None = None
        try:
            while not self._requested.is_set():
                coming = asyncio.ensure_future(anext(source))
                await asyncio.wait({coming, requested}, return_when=asyncio.FIRST_COMPLETED)
                if self._requested.is_set():
                    return
                try:
                    yield coming.result()
                except StopAsyncIteration:
                    return
        finally:
            requested.cancel()
            if coming is not None:
                coming.cancel()
