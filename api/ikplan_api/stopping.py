"""How the service ends: in order, and within a time that is known."""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import AsyncIterator
from typing import TypeVar

from ikplan_api.board import PlanBoard

__all__ = ["Stopping"]

T = TypeVar("T")

_log = logging.getLogger("ikplan.service")


class Stopping:
    """Ends what would never end by itself, and gives the rest some time.

    Args:
        board: The plans that are being made.
        stop_s: Time that those under way get to be finished [s].
    """

    def __init__(self, board: PlanBoard, stop_s: float) -> None:
        self._board = board
        self._stop_s = stop_s
        self._begun = asyncio.Event()
        self._deadline = math.inf

    def begin(self) -> float:
        """Be told that the service is to stop.

        Returns:
            Time that requests under way are to be given [s].
        """
        if not self._begun.is_set():
            self._deadline = time.monotonic() + self._stop_s
            self._begun.set()
            self._board.rest()
            _log.info("stopping: plans under way get %g s", self._stop_s)
        return self._stop_s

    async def settle(self) -> None:
        """Wait for the plans under way, no longer than their time."""
        self.begin()
        await self._board.settle(max(0.0, self._deadline - time.monotonic()))

    async def until_begun(self, source: AsyncIterator[T]) -> AsyncIterator[T]:
        """Pass on what comes from a source, until the service is to stop."""
        begun = asyncio.ensure_future(self._begun.wait())
        coming: asyncio.Future[T] | None = None
        try:
            while not self._begun.is_set():
                coming = asyncio.ensure_future(anext(source))
                await asyncio.wait({coming, begun}, return_when=asyncio.FIRST_COMPLETED)
                if self._begun.is_set():
                    return
                try:
                    yield coming.result()
                except StopAsyncIteration:
                    return
        finally:
            begun.cancel()
            if coming is not None:
                coming.cancel()
