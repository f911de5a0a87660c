"""A planner that plans nothing: it answers when it is told to, and remembers what it was asked."""

from __future__ import annotations

import asyncio
from typing import Any

from ikplan.errors import IkplanError, ServiceUnavailable
from ikplan.planning import Progress
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.attempts import Attempts
from ikplan_api.workers.tasks import TaskResult


class StandIn:
    """Does ``plan`` and ``time`` when :meth:`answer` or :meth:`fail` is called, in any order."""

    ready = True

    def __init__(self, room: int = 100) -> None:
        self.room = room
        self.asked: list[bytes] = []
        self.progress: list[Progress | None] = []
        self.cancelled: list[bytes] = []
        self._open: list[asyncio.Future[TaskResult]] = []

    @property
    def load(self) -> Load:
        return Load(1, len(self._open), 0)

    def check_capacity(self) -> None:
        if len(self._open) >= self.room:
            raise ServiceUnavailable("busy", status_code=503, retry_after_s=1.0)

    async def run(
        self, kind: str, document: bytes, *, wait_if_full: bool = False, **how: Any
    ) -> TaskResult:
        if not wait_if_full:
            self.check_capacity()
        assert kind in ("plan", "time")
        attempts: Attempts = how.get("attempts") or Attempts()
        return await attempts.run(lambda: self._attempt(document, attempts, how.get("progress")))

    async def _attempt(
        self, document: bytes, attempts: Attempts, progress: Progress | None
    ) -> TaskResult:
        attempts.begin()
        future: asyncio.Future[TaskResult] = asyncio.get_running_loop().create_future()
        self.asked.append(document)
        self.progress.append(progress)
        self._open.append(future)
        try:
            return await future
        except asyncio.CancelledError:
            attempts.withdraw()
            self.cancelled.append(document)
            raise
        finally:
            self._open.remove(future)

    def answer(self, document: bytes = b'{"plan": 1}') -> None:
        self._open[0].set_result(TaskResult(document, None))

    def fail(self, error: IkplanError | Exception) -> None:
        self._open[0].set_exception(error)

    async def warm_up(self) -> None:
        return None

    async def close(self) -> None:
        for future in self._open:
            future.set_exception(ServiceUnavailable("stopping", status_code=503))
        await asyncio.sleep(0)


class Idle(StandIn):
    """A planner that nobody asks."""

    async def run(self, kind: str, document: bytes, **_: Any) -> TaskResult:
        raise AssertionError(f"{kind} was asked for: {document!r}")
