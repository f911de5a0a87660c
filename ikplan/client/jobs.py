"""Plans that a service makes while the caller does something else."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

from ikplan.client import calls
from ikplan.client.connection import AsyncConnection, Connection
from ikplan.documents.status import PlanStatus
from ikplan.errors import IkplanError, PlanNotFound, ServiceUnavailable
from ikplan.plans.plan import Plan

__all__ = ["AsyncPlanJob", "OnProgress", "PlanJob"]

OnProgress = Callable[[PlanStatus], None]
"""Is told how far a plan is."""

_POLL_S = 1.0


class _Job:
    """What both kinds of jobs know.

    Attributes:
        id: Id of the plan.
    """

    def __init__(self, plan_id: str, plan: Plan | None = None) -> None:
        self.id = plan_id
        self._plan = plan

    def _unfinished(self, timeout: float) -> ServiceUnavailable:
        return ServiceUnavailable(
            f"plan {self.id} is not finished after {timeout:g} s; it goes on",
            url=calls.plan_path(self.id),
            status_code=202,
        )


class PlanJob(_Job):
    """A plan asked for with :meth:`ikplan.Client.submit`.

    Attributes:
        id: Id of the plan.
    """

    def __init__(self, client: Connection, plan_id: str, plan: Plan | None = None) -> None:
        super().__init__(plan_id, plan)
        self._client = client

    def status(self) -> PlanStatus:
        """Tell how far it is.

        Raises:
            IkplanError: Why it failed.
            PlanNotFound: It was cancelled.
        """
        found = self._client._send(calls.peek(self.id))
        return found if isinstance(found, PlanStatus) else _finished(found)

    def wait(self, *, timeout: float | None = None, progress: OnProgress | None = None) -> Plan:
        """Wait for the plan, by the service's events and, where they fail, by asking.

        Args:
            timeout: Longest wait [s]; None: as long as it takes.
            progress: Is told how far the plan is.

        Raises:
            IkplanError: Why it failed.
            PlanNotFound: It was cancelled.
            ServiceUnavailable: The time is up, or the service cannot be reached.
        """
        deadline = _Deadline(timeout)
        while self._plan is None:
            try:
                for event in self._client._watch(self.id, deadline.left):
                    _hear(event, progress)
                    if deadline.over:
                        break
            except ServiceUnavailable:
                pass  # asking tells whether it is the service or only the stream
            found = self._client._send(calls.peek(self.id))
            if isinstance(found, Plan):
                self._plan = found
            elif deadline.over:
                raise self._unfinished(deadline.timeout)
            else:
                time.sleep(min(_POLL_S, deadline.left))
        return self._plan

    def cancel(self) -> None:
        """Stop the work, or forget the finished plan.

        Raises:
            PlanNotFound: There is none any more.
        """
        self._client._send(calls.delete_plan(self.id))


class AsyncPlanJob(_Job):
    """A plan asked for with :meth:`ikplan.AsyncClient.submit`; its twin is PlanJob.

    Attributes:
        id: Id of the plan.
    """

    def __init__(self, client: AsyncConnection, plan_id: str, plan: Plan | None = None) -> None:
        super().__init__(plan_id, plan)
        self._client = client

    async def status(self) -> PlanStatus:
        """Tell how far it is.

        Raises:
            IkplanError: Why it failed.
            PlanNotFound: It was cancelled.
        """
        found = await self._client._send(calls.peek(self.id))
        return found if isinstance(found, PlanStatus) else _finished(found)

    async def wait(
        self, *, timeout: float | None = None, progress: OnProgress | None = None
    ) -> Plan:
        """Wait for the plan, by the service's events and, where they fail, by asking.

        Args:
            timeout: Longest wait [s]; None: as long as it takes.
            progress: Is told how far the plan is.

        Raises:
            IkplanError: Why it failed.
            PlanNotFound: It was cancelled.
            ServiceUnavailable: The time is up, or the service cannot be reached.
        """
        deadline = _Deadline(timeout)
        while self._plan is None:
            try:
                async for event in self._client._watch(self.id, deadline.left):
                    _hear(event, progress)
                    if deadline.over:
                        break
            except ServiceUnavailable:
                pass  # asking tells whether it is the service or only the stream
            found = await self._client._send(calls.peek(self.id))
            if isinstance(found, Plan):
                self._plan = found
            elif deadline.over:
                raise self._unfinished(deadline.timeout)
            else:
                await asyncio.sleep(min(_POLL_S, deadline.left))
        return self._plan

    async def cancel(self) -> None:
        """Stop the work, or forget the finished plan.

        Raises:
            PlanNotFound: There is none any more.
        """
        await self._client._send(calls.delete_plan(self.id))


class _Deadline:
    """When a wait is over."""

    def __init__(self, timeout: float | None) -> None:
        self.timeout = float("inf") if timeout is None else timeout
        self._end = time.monotonic() + self.timeout

    @property
    def left(self) -> float:
        return max(0.0, self._end - time.monotonic())

    @property
    def over(self) -> bool:
        return self.left == 0.0


def _finished(plan: Plan) -> PlanStatus:
    return PlanStatus(id=plan.id, state="finished")


def _hear(event: PlanStatus | IkplanError, progress: OnProgress | None) -> None:
    """Pass on what an event says, or raise it."""
    if isinstance(event, IkplanError):
        raise event
    if event.state == "cancelled":
        raise PlanNotFound(f"plan {event.id} was cancelled", id=event.id)
    if progress is not None:
        progress(event)
