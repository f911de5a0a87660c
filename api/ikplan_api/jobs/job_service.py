"""Interface of the plan jobs: what the handlers ask for, however many replicas there are."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any, Protocol

from ikplan.documents.status import PlanStatus
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.store.plan_query import ListedPlan, PlanQuery
from ikplan_api.store.plan_store import Job
from ikplan_api.telemetry.load import JobSource

__all__ = ["JobService", "WatchedJob"]


class WatchedJob(Protocol):
    """A job in progress, in this replica or another one."""

    @property
    def status(self) -> PlanStatus:
        """Its progress when it was looked for."""

    @property
    def problem(self) -> dict[str, Any] | None:
        """The problem document, once it failed."""

    def watch(self) -> AsyncIterator[PlanStatus]:
        """Yield the status now and after every change, until the end."""


class JobService(JobSource, Protocol):
    """Runs plan jobs: deduplicates, stores, watches and cancels them, each owner's apart."""

    async def resume(self) -> None:
        """Begin: start the jobs that were accepted before, or join the other replicas.

        Raises:
            StoreFault: The store cannot be read.
        """

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
        """Identify a request: its plan id and its time budget.

        Args:
            kind: ``"plan"`` or ``"time"``.
            document: The request document.
            robot: The uploaded robot that it names; None: a robot of the catalogue.
            known: What is known of it already.
            owner: Whose request it is.
            wait_if_full: If the queue is full, wait instead of raising.

        Raises:
            IkplanError: The request is invalid.
            ServiceUnavailable: The queue is full and the request was not seen before.
        """

    async def find(self, plan_id: str, owner: str) -> bytes | None:
        """Return a finished plan, or None if it is not stored.

        Raises:
            StoreFault: The read fails.
        """

    async def run(self, job: Job, *, wait_if_full: bool = False) -> bytes:
        """Return a stored plan, join its job in progress, or start a new one.

        Cancellation leaves the job; without other clients it is cancelled too.

        Args:
            job: The job.
            wait_if_full: If the queue is full, wait instead of raising.

        Raises:
            IkplanError: The verdict on the request, or that the queue is full.
            StoreFault: The store cannot be read or written.
        """

    async def accept(self, job: Job) -> PlanStatus:
        """Accept a job, which will run even if the service is killed before.

        Raises:
            ServiceUnavailable: The queue is full, or the store cannot write.
        """

    async def in_progress(self, plan_id: str, owner: str) -> WatchedJob | None:
        """Return a plan in progress, or None.

        Raises:
            StoreFault: The read fails.
        """

    async def list(self, query: PlanQuery) -> list[ListedPlan]:
        """Return stored plans and jobs, the newest first, one more than the limit if there are.

        Raises:
            StoreFault: The read fails.
        """

    async def failure(self, plan_id: str, owner: str) -> dict[str, Any] | None:
        """Return the problem document of a failed job, or None.

        Raises:
            StoreFault: The read fails.
        """

    async def cancel(self, plan_id: str, owner: str) -> None:
        """Cancel a job or delete a plan; clients that wait for the same plan still receive it.

        Raises:
            PlanNotFound: No plan and no job has this id.
            StoreFault: The deletion fails.
        """

    def park_queued(self) -> None:
        """Start no more jobs; those that wait run after the next start, or elsewhere."""

    async def drain(self, timeout_s: float) -> None:
        """Wait until the jobs in progress end, at most ``timeout_s`` [s]."""

    async def close(self) -> None:
        """Wait for the jobs that ended with the planner and for pending writes."""
