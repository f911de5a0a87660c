"""Where finished plans, and jobs that are not finished, are kept."""

from __future__ import annotations

from collections import OrderedDict
from typing import NamedTuple, Protocol

__all__ = ["Job", "PlanStore", "RecentPlans", "StoreFault"]


class StoreFault(Exception):
    """The store cannot keep anything now: its disk is full, or broken."""


class Job(NamedTuple):
    """A request that was accepted: it will be done, whatever happens to the service meanwhile.

    Attributes:
        plan_id: Id of its plan.
        kind: ``"plan"`` or ``"time"``.
        document: The request document.
        robot: The upload of the robot that it names; None: one of the catalogue.
        budget_s: Its time budget [s].
    """

    plan_id: str
    kind: str
    document: bytes
    robot: bytes | None
    budget_s: float


class PlanStore(Protocol):
    """Finished plans by id, as the bytes that were answered, and jobs."""

    async def open(self) -> None:
        """Get ready.

        Raises:
            InvalidRequest: The place to keep them cannot be used; names the setting.
        """

    async def close(self) -> None:
        """Give everything free."""

    async def put(self, plan_id: str, document: bytes) -> None:
        """Keep a plan; the job that asked for it is done.

        Raises:
            StoreFault: It cannot be kept.
        """

    async def get(self, plan_id: str) -> bytes | None:
        """Return a plan, or None if it is not kept."""

    async def accept(self, job: Job) -> None:
        """Keep a job until it is done, has failed or is deleted.

        Raises:
            StoreFault: It cannot be kept.
        """

    async def fail(self, plan_id: str, problem: bytes) -> None:
        """Keep the problem document of a job that failed.

        Raises:
            StoreFault: It cannot be kept.
        """

    async def problem(self, plan_id: str) -> bytes | None:
        """Return why a job failed, or None if none of that id has."""

    async def delete(self, plan_id: str) -> bool:
        """Forget a plan, a job and its failure; return whether there was any.

        Raises:
            StoreFault: It cannot be forgotten.
        """

    async def pending(self) -> list[Job]:
        """Return the jobs that are neither done nor failed, in the order they were accepted."""


class RecentPlans:
    """The plans used last, in memory.

    Args:
        max_plans: Most plans kept.
        max_bytes: Size of all plans kept [bytes]; a larger plan is not kept at all.
    """

    def __init__(self, max_plans: int, max_bytes: int) -> None:
        self._max_plans = max_plans
        self._max_bytes = max_bytes
        self._plans: OrderedDict[str, bytes] = OrderedDict()
        self._bytes = 0

    def put(self, plan_id: str, document: bytes) -> None:
        """Keep a plan; those unused for longest make room for it."""
        self.delete(plan_id)
        if len(document) > self._max_bytes:
            return
        self._plans[plan_id] = document
        self._bytes += len(document)
        while len(self._plans) > self._max_plans or self._bytes > self._max_bytes:
            _, oldest = self._plans.popitem(last=False)
            self._bytes -= len(oldest)

    def get(self, plan_id: str) -> bytes | None:
        """Return a plan, or None if it is not kept."""
        if plan_id in self._plans:
            self._plans.move_to_end(plan_id)
        return self._plans.get(plan_id)

    def delete(self, plan_id: str) -> bool:
        """Forget a plan; return whether it was kept."""
        document = self._plans.pop(plan_id, None)
        self._bytes -= len(document or b"")
        return document is not None
