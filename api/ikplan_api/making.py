"""One plan that is being made, for all who want it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

from ikplan.documents.status import PlanStatus
from ikplan_api.store import Job
from ikplan_api.tasks import Answer

__all__ = ["Making"]


class Making:
    """A plan under way.

    Args:
        job: What is asked for.

    Attributes:
        task: The work; set by who begins it.
        waiters: How many wait for its answer.
        accepted: Whether it is to be done though nobody waits.
        problem: Why it failed, as a problem document, once it has.
    """

    task: asyncio.Task[Answer]

    def __init__(self, job: Job) -> None:
        self.job = job
        self.waiters = 0
        self.accepted = False
        self.problem: dict[str, Any] | None = None
        self._status = PlanStatus(id=job.plan_id, state="queued")
        self._changed = asyncio.Event()

    @property
    def status(self) -> PlanStatus:
        """How far it is."""
        return self._status

    def progress(self, stage: str, done: int, total: int) -> None:
        """Be told how far it is."""
        self._change(state="running", stage=stage, done=done, total=total)

    def end(self) -> None:
        """Be told that the work has ended, one way or another."""
        if self.task.cancelled():
            state = "cancelled"
        else:
            state = "failed" if self.task.exception() else "finished"
        self._change(state=state)

    def _change(self, **news: Any) -> None:
        self._status = self._status.model_copy(update=news)
        self._changed.set()
        self._changed = asyncio.Event()

    async def watch(self) -> AsyncIterator[PlanStatus]:
        """Tell how far it is, now and at every change, until it has ended."""
        while True:
            # What changes while a listener is busy is told by its newest state only.
            changed, status = self._changed, self._status
            yield status
            if status.ended:
                return
            if self._status is status:
                await changed.wait()
