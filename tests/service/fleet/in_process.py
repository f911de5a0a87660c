"""A planner that does real work in a thread of this process, as slowly as it is told to."""

from __future__ import annotations

import asyncio
from typing import Any

from ikplan.errors import ServiceUnavailable
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.tasks import TaskInput, TaskResult, run_task


class InProcess:
    """One worker.

    Attributes:
        go: Plans and timings wait for it.
        made: Plans that were made.
    """

    ready = True

    def __init__(self) -> None:
        self.go = asyncio.Event()
        self.go.set()
        self.made: list[str] = []
        self._pending = 0
        self._turn = asyncio.Semaphore(1)

    @property
    def load(self) -> Load:
        return Load(1, min(1, self._pending), max(0, self._pending - 1))

    def check_capacity(self) -> None:
        if self._pending > 100:
            raise ServiceUnavailable("busy", status_code=503, retry_after_s=1.0)

    async def run(
        self,
        kind: str,
        document: bytes,
        *,
        robot: bytes | None = None,
        known: KnownRequest = UNKNOWN,
        **how: Any,
    ) -> TaskResult:
        self._pending += 1
        try:
            async with self._turn:
                loop = asyncio.get_running_loop()
                told = how.get("progress")
                if kind in ("plan", "time"):
                    if told is not None:
                        told("ik", 0, 1)
                    await self.go.wait()

                def progress(stage: str, done: int, total: int) -> None:
                    if told is not None:
                        loop.call_soon_threadsafe(told, stage, done, total)

                task = TaskInput(document, robot, known, progress)
                result = await asyncio.to_thread(run_task, kind, task)
                if kind in ("plan", "time"):
                    self.made.append(str(result.plan_id))
                return result
        finally:
            self._pending -= 1

    async def warm_up(self) -> None:
        return None

    async def close(self) -> None:
        self.go.set()  # what a test that failed has left waiting
