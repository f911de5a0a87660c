"""Interface of a store for finished plans and unfinished jobs."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.store.owners import EVERYONE
from ikplan_api.store.plan_query import ListedPlan, PlanQuery

__all__ = ["AuditRow", "Job", "OpenStore", "PlanStore", "StoreFault"]


class StoreFault(Exception):
    """The store cannot write or read now: the disk is full or broken, or the database is down.

    Args:
        message: Why.
        retry_after_s: Time after which it may work again [s].
    """

    def __init__(self, message: str, retry_after_s: float = 60.0) -> None:
        super().__init__(message)
        self.retry_after_s = retry_after_s


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
        owner: Whose it is.
        robot_name: Name of its robot; empty: unknown.
    """

    plan_id: str
    kind: str
    document: bytes
    robot: bytes | None
    budget_s: float
    known: KnownRequest = UNKNOWN
    attempts: int = 0
    owner: str = EVERYONE
    robot_name: str = ""


class AuditRow(NamedTuple):
    """An action on a plan.

    Attributes:
        place: Its number, larger for later ones.
        time: When [s since 1970].
        owner: Name of the key.
        action: What was done.
        subject: Id of the plan.
        robot: Name of the robot; empty: unknown.
        replica: The replica; empty: there is one service.
        attempt: Number of the claim.
    """

    place: int
    time: float
    owner: str
    action: str
    subject: str
    robot: str
    replica: str = ""
    attempt: int = 0


class OpenStore(Protocol):
    """What every store is, of one service or of several replicas."""

    @property
    def shared(self) -> bool:
        """Whether it was begun when all keys shared their plans; known once it is open."""

    async def open(self) -> None:
        """Open the store.

        Raises:
            InvalidRequest: The storage cannot be used; names the setting.
        """

    async def close(self) -> None:
        """Release every resource."""

    async def audit(self, owner: str | None, before: int | None, limit: int) -> list[AuditRow]:
        """Return what was done, the newest first.

        Args:
            owner: Whose actions; None: all.
            before: Place before which they are; None: the end.
            limit: Most rows.

        Raises:
            StoreFault: The read fails.
        """


class PlanStore(OpenStore, Protocol):
    """Finished plans by owner and id, as the bytes of the response, and jobs."""

    async def put(
        self,
        plan_id: str,
        document: bytes,
        *,
        owner: str = EVERYONE,
        kind: str = "plan",
        robot: str = "",
    ) -> None:
        """Store a plan and delete the job that requested it.

        Args:
            plan_id: Its id.
            document: The plan.
            owner: Whose it is.
            kind: ``"plan"`` or ``"time"``.
            robot: Name of its robot.

        Raises:
            StoreFault: The write fails.
        """

    async def get(self, plan_id: str, owner: str = EVERYONE) -> bytes | None:
        """Return a plan, or None if it is not stored."""

    async def accept(self, job: Job) -> None:
        """Store a job until it finishes, fails or is deleted.

        Raises:
            StoreFault: The write fails.
        """

    async def count_attempts(self, plan_id: str, attempts: int, owner: str = EVERYONE) -> None:
        """Store how often a worker began an unfinished job.

        Raises:
            StoreFault: The write fails.
        """

    async def fail(self, plan_id: str, problem: bytes, owner: str = EVERYONE) -> None:
        """Store the problem document of a failed job.

        Raises:
            StoreFault: The write fails.
        """

    async def problem(self, plan_id: str, owner: str = EVERYONE) -> bytes | None:
        """Return the problem document of a failed job, or None."""

    async def delete(self, plan_id: str, owner: str = EVERYONE) -> bool:
        """Delete a plan, a job and its failure; return whether any existed.

        Raises:
            StoreFault: The write fails.
        """

    async def pending(self) -> list[Job]:
        """Return the unfinished jobs in the order of their acceptance."""

    async def list(self, query: PlanQuery) -> list[ListedPlan]:
        """Return plans and jobs, the newest first, one more than the limit if there are more.

        Raises:
            StoreFault: The read fails.
        """
