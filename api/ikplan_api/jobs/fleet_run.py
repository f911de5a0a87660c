"""One job that this replica runs."""

from __future__ import annotations

import asyncio

from ikplan.errors import IkplanError, WorkerLost
from ikplan_api.store.plan_store import Job, StoreFault
from ikplan_api.store.postgres.queue import Claim, PostgresQueue
from ikplan_api.workers.attempts import Attempts
from ikplan_api.workers.tasks import TaskResult

__all__ = ["FleetAttempts", "FleetRun"]

_QUIET_S = 0.05
"""Time after which a job tells its first progress: a short one tells its end alone [s]."""
_EVERY_S = 0.2
"""Least time between two reports of one job: each one is a commit [s]."""


class FleetAttempts(Attempts):
    """Attempts of a job by workers of this replica.

    Args:
        run: The job.
    """

    def __init__(self, run: FleetRun) -> None:
        super().__init__()
        self._run = run

    def verdict(self, lost: WorkerLost) -> IkplanError:
        """Return the answer to a caller; an accepted job is not left open."""
        return self.lost(lost) if self._run.accepted else super().verdict(lost)


class FleetRun:
    """A claimed job.

    Args:
        claim: The claim.

    Attributes:
        task: The running task; set by the code that starts it.
        waiters: Number of clients of this replica that wait for the result.
        accepted: Whether it was accepted when it was claimed.
        held: Whether the claim still holds, as far as is known.
        ending: Whether its end is being written: then its row may just be gone.
    """

    task: asyncio.Task[TaskResult]

    def __init__(self, claim: Claim) -> None:
        self.claim = claim
        self.waiters = 0
        self.accepted = claim.accepted
        self.held = True
        self.ending = False
        self._latest = ("", 0, 0)
        self._changed = asyncio.Event()

    @property
    def job(self) -> Job:
        """The job."""
        return self.claim.job

    def progress(self, stage: str, done: int, total: int) -> None:
        """Receive a progress report of the planner."""
        self._latest = (stage, done, total)
        self._changed.set()

    async def report(self, queue: PostgresQueue) -> None:
        """Tell the other replicas of the progress, now and then, until cancelled."""
        await asyncio.sleep(_QUIET_S)
        while True:
            await self._changed.wait()
            self._changed.clear()
            try:
                await queue.progress(self.claim, *self._latest)
            except StoreFault:
                self._changed.set()  # again, once the database is back
            await asyncio.sleep(_EVERY_S)
