"""The attempts of a job, counted in the store: they survive the service."""

from __future__ import annotations

import asyncio
import logging

from ikplan.errors import IkplanError, WorkerLost
from ikplan_api.store.plan_store import Job, PlanStore, StoreFault
from ikplan_api.workers.attempts import Attempts

__all__ = ["JobAttempts", "given_up"]

_log = logging.getLogger("ikplan.service")

_MOST = 3
"""Attempts of a job in all, where the service itself ended in them."""
_ENDED_WITH_SERVICE = 1
"""Exit code of a worker whose service ended."""


def given_up(job: Job) -> WorkerLost | None:
    """Return the verdict on a stored job that is not tried again, or None.

    A job that takes the service with it, for example by the memory of the machine, would otherwise
    do so at every start.
    """
    if job.attempts < _MOST:
        return None
    return WorkerLost(
        f"the service ended in the midst of the request, which was tried {job.attempts} times",
        exit_code=_ENDED_WITH_SERVICE,
    )


class JobAttempts(Attempts):
    """The attempts of one job.

    Args:
        job: The job.
        store: The store of accepted jobs.

    Attributes:
        accepted: Whether the job is accepted: only then its attempts are stored.
    """

    def __init__(self, job: Job, store: PlanStore) -> None:
        super().__init__(job.attempts)
        self.accepted = False
        self._job = job
        self._store = store
        self._writing: set[asyncio.Task[None]] = set()

    def begin(self) -> None:
        """Count an attempt."""
        super().begin()
        self.save()

    def withdraw(self) -> None:
        """Take back the latest attempt."""
        super().withdraw()
        self.save()

    def verdict(self, lost: WorkerLost) -> IkplanError:
        """Return the answer to a caller; an accepted job is not left open."""
        return self.lost(lost) if self.accepted else super().verdict(lost)

    def save(self) -> None:
        """Store the count of an accepted job, in the background."""
        if self.accepted:
            writing = asyncio.create_task(self._save(self.begun))
            self._writing.add(writing)
            writing.add_done_callback(self._writing.discard)

    async def _save(self, begun: int) -> None:
        try:
            await self._store.count_attempts(self._job.plan_id, begun, self._job.owner)
        except StoreFault as error:
            _log.error("failed to store an attempt: %s", error)

    async def saved(self) -> None:
        """Wait until the count is stored."""
        if self._writing:
            await asyncio.wait(set(self._writing))
