"""Interface of a store for finished plans and unfinished jobs."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ikplan.pipeline.identity import UNKNOWN, KnownRequest

__all__ = ["Job", "PlanStore", "StoreFault"]


class StoreFault(Exception):
    """The store cannot write or read now: the disk is full or broken."""


class Job(NamedTuple):
    """A request for a plan.

    Attributes:
        plan_id: Id of its plan.
        kind: ``"plan"`` or ``"time"``.
        document: The request document.
        robot: The uploaded robot that the document names; None: a robot of the catalogue.
        budget_s: Its time budget [s].
        known: What is known of the request already; not stored.
        attempts: How often a worker began it.
    """

    plan_id: str
    kind: str
    document: bytes
    robot: bytes | None
    budget_s: float
    known: KnownRequest = UNKNOWN
    attempts: int = 0


class PlanStore(Protocol):
    """Finished plans by id, as the bytes of the response, and jobs."""

    async def open(self) -> None:
        """Open the store.

        Raises:
            InvalidRequest: The storage cannot be used; names the setting.
        """

    async def close(self) -> None:
        """Release every resource."""

    async def put(self, plan_id: str, document: bytes) -> None:
        """Store a plan and delete the job that requested it.

        Raises:
            StoreFault: The write fails.
        """

    async def get(self, plan_id: str) -> bytes | None:
        """Return a plan, or None if it is not stored."""

    async def accept(self, job: Job) -> None:
        """Store a job until it finishes, fails or is deleted.

        Raises:
            StoreFault: The write fails.
        """

    async def count_attempts(self, plan_id: str, attempts: int) -> None:
        """Store how often a worker began an unfinished job.

        Raises:
            StoreFault: The write fails.
        """

    async def fail(self, plan_id: str, problem: bytes) -> None:
        """Store the problem document of a failed job.

        Raises:
            StoreFault: The write fails.
        """

    async def problem(self, plan_id: str) -> bytes | None:
        """Return the problem document of a failed job, or None."""

    async def delete(self, plan_id: str) -> bool:
        """Delete a plan, a job and its failure; return whether any existed.

        Raises:
            StoreFault: The write fails.
        """

    async def pending(self) -> list[Job]:
        """Return the unfinished jobs in the order of their acceptance."""
