"""One plan in progress, shared by every client that waits for it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

from ikplan.documents.status import PlanStatus
from ikplan_api.jobs.job_attempts import JobAttempts
from ikplan_api.store.plan_store import Job
from ikplan_api.workers.tasks import TaskResult

__all__ = ["PlanInProgress"]


class PlanInProgress:
    """A plan in progress.

    Args:
        job: The job.
        attempts: Its attempts.

    Attributes:
        task: The running task; set by the code that starts it.
        waiters: Number of clients that wait for the result.
        problem: The problem document, once it failed.
    """

    task: asyncio.Task[TaskResult]

    def __init__(self, job: Job, attempts: JobAttempts) -> None:
        self.job = job
        self.attempts = attempts
        self.waiters = 0
        self.problem: dict[str, Any] | None = None
        self._status = PlanStatus(id=job.plan_id, state="queued")
        self._changed = asyncio.Event()

    @property
    def accepted(self) -> bool:
        """Whether it continues without waiting clients."""
        return self.attempts.accepted

    @accepted.setter
    def accepted(self, value: bool) -> None:
        self.attempts.accepted = value

    @property
    def status(self) -> PlanStatus:
        """Current progress."""
        return self._status

    def progress(self, stage: str, done: int, total: int) -> None:
        """Receive a progress report of the planner."""
        self._update(state="running", stage=stage, done=done, total=total)

    def end(self) -> None:
        """Record that the task ended: finished, failed or cancelled."""
        if self.task.cancelled():
            state = "cancelled"
        else:
            state = "failed" if self.task.exception() else "finished"
        self._update(state=state)

    def _update(self, **fields: Any) -> None:
        # Of our own making: nothing is to be validated, and this is done for every report.
        self._status = PlanStatus.model_construct(**{**self._status.__dict__, **fields})
        self._changed.set()
        self._changed = asyncio.Event()

    async def watch(self) -> AsyncIterator[PlanStatus]:
        """Yield the status now and after every change, until the end."""
        while True:
            # A slow listener skips intermediate states and receives the newest one.
            changed, status = self._changed, self._status
            yield status
            if status.ended:
                return
            if self._status is status:
                await changed.wait()
