"""Writes of the ends of jobs, which wait for a database that does not answer."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from ikplan_api.store.plan_store import StoreFault

__all__ = ["AGAIN_S", "SETTLE_S", "FleetWrites"]

AGAIN_S = 0.5
"""Time between two attempts to reach the database [s]."""
SETTLE_S = 60.0
"""Time for which the end of a job waits for the database [s]."""

_log = logging.getLogger("ikplan.service")
T = TypeVar("T")


class FleetWrites:
    """Writes of one replica that are repeated until the database answers."""

    def __init__(self) -> None:
        self._pending: set[asyncio.Task[Any]] = set()

    async def settle(self, write: Callable[[], Awaitable[T]], within_s: float = SETTLE_S) -> T:
        """Write, again and again while the database does not answer.

        Args:
            write: Makes one attempt.
            within_s: Time after which no further attempt is made [s].

        Raises:
            StoreFault: It does not answer for too long.
        """
        deadline = time.monotonic() + within_s
        while True:
            try:
                return await write()
            except StoreFault as error:
                if time.monotonic() > deadline:
                    raise
                _log.warning("the database does not answer now: %s", error)
                await asyncio.sleep(AGAIN_S)

    def later(self, writing: Awaitable[Any]) -> None:
        """Write in the background."""
        task = asyncio.ensure_future(writing)
        self._pending.add(task)
        task.add_done_callback(self._settled)

    def _settled(self, task: asyncio.Future[Any]) -> None:
        self._pending.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            _log.error("failed to give a job back, its lease will end: %s", error)

    async def settled(self) -> None:
        """Wait for what is written in the background."""
        if self._pending:
            await asyncio.wait(set(self._pending))
