"""Jobs that run in this replica, and who waits for them: of one replica and of several."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

from ikplan.errors import BudgetExceeded, ServiceUnavailable
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.jobs.request_identity import RequestIdentifier
from ikplan_api.store.plan_store import Job
from ikplan_api.workers.attempts import Attempts
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.tasks import TaskResult

__all__ = ["Key", "RunningJob", "RunningJobs", "key_of"]

Key = tuple[str, str]
"""Owner and plan id of a job: equal requests of two owners are two jobs."""


def key_of(job: Job) -> Key:
    """Return the key of a job."""
    return job.owner, job.plan_id


class RunningJob(Protocol):
    """A job that runs here.

    Attributes:
        task: The running task.
        waiters: Number of clients of this replica that wait for the result.
    """

    task: asyncio.Task[TaskResult]
    waiters: int

    @property
    def job(self) -> Job:
        """The job."""

    def progress(self, stage: str, done: int, total: int) -> None:
        """Receive a progress report of the planner."""


R = TypeVar("R", bound=RunningJob)


class RunningJobs(ABC, Generic[R]):
    """Jobs that run here; each is run once, however many clients wait for it.

    Args:
        planner: The planner.
        max_budget_s: Upper limit of every time budget [s].
        quota: Returns the most accepted and unfinished jobs of an owner; None: no limit.
    """

    def __init__(
        self, planner: Planner, max_budget_s: float, quota: Callable[[str], int | None]
    ) -> None:
        self._planner = planner
        self._quota = quota
        self._identifier = RequestIdentifier(planner, max_budget_s)
        self._running: dict[Key, R] = {}
        self.ends: dict[str, int] = {}

    async def identify(
        self,
        kind: str,
        document: bytes,
        robot: bytes | None,
        known: KnownRequest = UNKNOWN,
        *,
        owner: str,
        wait_if_full: bool = False,
    ) -> Job:
        """Identify a request; see :meth:`ikplan_api.jobs.job_service.JobService.identify`."""
        return await self._identifier.identify(
            kind, document, robot, known, owner=owner, wait_if_full=wait_if_full
        )

    @abstractmethod
    async def find(self, plan_id: str, owner: str) -> bytes | None:
        """Return a finished plan, or None if it is not stored."""

    async def run(self, job: Job, *, wait_if_full: bool = False) -> bytes:
        """Return a stored plan, join its job, or start a new one.

        Cancellation leaves the job; without other clients it is cancelled too.

        Args:
            job: The job.
            wait_if_full: If the queue is full, wait instead of raising.

        Raises:
            IkplanError: The verdict on the request, or that the queue is full.
        """
        while True:
            if (document := await self.find(job.plan_id, job.owner)) is not None:
                return document
            running = self._running.get(key_of(job)) or await self._begin(job, wait_if_full)
            if running is None:
                continue
            try:
                return (await self._join(running)).document
            except BudgetExceeded:
                # The joined job had a smaller budget; this one may suffice.
                if running.job.budget_s >= job.budget_s:
                    raise

    @abstractmethod
    async def _begin(self, job: Job, wait_if_full: bool) -> R | None:
        """Start a job that clients wait for; None: it was waited for elsewhere."""

    def _launch(self, running: R, wait_if_full: bool) -> R:
        """Run a job in a task of its own."""
        self._running[key_of(running.job)] = running
        running.task = asyncio.create_task(self._run(running, wait_if_full))
        running.task.add_done_callback(lambda _: self._ended(running))
        return running

    @abstractmethod
    async def _run(self, running: R, wait_if_full: bool) -> TaskResult:
        """Plan, and store the plan or the verdict."""

    @abstractmethod
    def _ended(self, running: R) -> None:
        """Clear up behind a task that is done."""

    def _remove(self, running: R) -> None:
        key = key_of(running.job)
        if self._running.get(key) is running:
            del self._running[key]

    async def _join(self, running: R) -> TaskResult:
        running.waiters += 1
        try:
            return await asyncio.shield(running.task)
        finally:
            running.waiters -= 1
            self._left(running)

    @abstractmethod
    def _left(self, running: R) -> None:
        """Stop a job that a client has left, if nobody wants it any more."""

    async def _plan(self, running: R, attempts: Attempts, wait_if_full: bool) -> TaskResult:
        """Plan, in more than one attempt if a worker ends.

        Raises:
            IkplanError: The verdict.
        """
        job = running.job
        return await self._planner.run(
            job.kind,
            job.document,
            robot=job.robot,
            known=job.known,
            limit_s=job.budget_s,
            progress=running.progress,
            wait_if_full=wait_if_full,
            attempts=attempts,
        )

    def _check_quota(self, owner: str, owned: int) -> None:
        """Refuse a further job of an owner who has as many as it may have.

        Raises:
            ServiceUnavailable: It has.
        """
        most = self._quota(owner)
        if most is not None and owned >= most:
            raise self._full(f"the key has {owned} unfinished jobs, as many as it may have")

    @staticmethod
    def _full(why: str) -> ServiceUnavailable:
        return ServiceUnavailable(
            f"{why}; try again later", status_code=ServiceUnavailable.status, retry_after_s=5.0
        )

    @staticmethod
    def _not_stored(how: str, retry_after_s: float) -> ServiceUnavailable:
        return ServiceUnavailable(
            f"jobs cannot be stored now and are not accepted; {how}",
            status_code=ServiceUnavailable.status,
            retry_after_s=retry_after_s,
        )

    def _count(self, end: str) -> None:
        self.ends[end] = self.ends.get(end, 0) + 1

    async def drain(self, timeout_s: float | None) -> None:
        """Wait until the jobs in progress end, at most ``timeout_s`` [s]; None: however long."""
        if self._running:
            await asyncio.wait([r.task for r in self._running.values()], timeout=timeout_s)
