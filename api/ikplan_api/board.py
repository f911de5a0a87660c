"""The plans that are being made: each request once, however many want it."""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import json
import logging
from collections import OrderedDict
from typing import Any

from ikplan.documents.status import PlanStatus
from ikplan.errors import (
    BudgetExceeded,
    IkplanError,
    PlanNotFound,
    ServiceUnavailable,
)
from ikplan_api.identity import identify
from ikplan_api.making import Making
from ikplan_api.planner import Planner
from ikplan_api.problems import http_problem, plain
from ikplan_api.store import Job, PlanStore, RecentPlans, StoreFault
from ikplan_api.tasks import Answer

__all__ = ["PlanBoard"]

_SEEN = 4096
"""Requests remembered to have been here before."""

_KEEPING = 8
"""Plans that may be answered before they are kept."""

_log = logging.getLogger("ikplan.service")


class PlanBoard:
    """Makes plans, keeps them, and knows of each whether it is wanted.

    Args:
        planner: Makes the plans.
        store: Keeps them, and the jobs.
        max_budget_s: Longest time that any plan may take, whatever its budget [s].
    """

    def __init__(self, planner: Planner, store: PlanStore, max_budget_s: float) -> None:
        self._planner = planner
        self._store = store
        self._max_budget_s = max_budget_s
        self._making: dict[str, Making] = {}
        self._seen: OrderedDict[bytes, None] = OrderedDict()
        # Those that are not kept yet, and those that the store could not keep.
        self._recent = RecentPlans(max_plans=256, max_bytes=64 * 2**20)
        self._keeping: dict[str, asyncio.Task[None]] = {}

    async def resume(self) -> None:
        """Begin the jobs that were accepted before a restart, in their order."""
        for job in await self._store.pending():
            if job.plan_id not in self._making:
                self._begin(job, patient=True).accepted = True

    async def identify(
        self, kind: str, document: bytes, robot: bytes | None, *, patient: bool = False
    ) -> Job:
        """Tell the id of a request before it is planned.

        Args:
            kind: ``"plan"`` or ``"time"``.
            document: The request document.
            robot: The upload of the robot that it names; None: one of the catalogue.
            patient: Wait for room to read it, instead of being refused.

        Raises:
            IkplanError: What is wrong with the request.
            ServiceUnavailable: There is no room, and the request has not been here before.
        """
        digest = hashlib.sha256(b"\0".join((kind.encode(), robot or b"", document))).digest()
        if digest not in self._seen and not patient:
            # What may already be kept or under way is worth reading for a busy service, no more.
            self._planner.check_room()
        identity = await identify(self._planner, kind, document, robot, patient=patient)
        budget_s = min(identity.budget_s, self._max_budget_s)
        self._seen[digest] = None
        while len(self._seen) > _SEEN:
            self._seen.popitem(last=False)
        return Job(identity.plan_id, kind, document, robot, budget_s)

    async def find(self, plan_id: str) -> bytes | None:
        """Return a finished plan, or None if it is not kept."""
        recent = self._recent.get(plan_id)
        # Or made while the store was looking.
        return recent or await self._store.get(plan_id) or self._recent.get(plan_id)

    async def make(self, job: Job, *, patient: bool = False) -> bytes:
        """Return a plan, made now unless it is kept or being made; cancelled: no longer wanted.

        Args:
            job: What is asked for.
            patient: Wait for room, instead of being refused.

        Raises:
            IkplanError: The verdict on the request, or that there is no room.
        """
        while True:
            if (document := await self.find(job.plan_id)) is not None:
                return document
            making = self._making.get(job.plan_id) or self._begin(job, patient=patient)
            try:
                return (await self._join(making)).document
            except BudgetExceeded:
                # What another allowed less time for may still be done within this budget.
                if making.job.budget_s >= job.budget_s:
                    raise

    async def accept(self, job: Job) -> PlanStatus:
        """Accept a job: it is done even if the service is killed in between.

        Raises:
            ServiceUnavailable: There is no room, or it cannot be kept.
        """
        making = self._making.get(job.plan_id)
        if making is None or not making.accepted:
            if making is None:
                self._planner.check_room()
            try:
                await self._store.accept(job)
            except StoreFault as error:
                _log.error("a job could not be kept: %s", error)
                raise ServiceUnavailable(
                    "jobs cannot be kept now, and so not be accepted; without Prefer: "
                    "respond-async the plan is made and answered",
                    status_code=ServiceUnavailable.status,
                    retry_after_s=60.0,
                ) from error
            # Somebody else may have begun it meanwhile.
            making = self._making.get(job.plan_id) or self._begin(job, patient=True)
            making.accepted = True
        return making.status

    def rest(self) -> None:
        """Put off the jobs that wait for a worker: they are done after the next start."""
        for making in list(self._making.values()):
            if not making.waiters and making.status.state == "queued":
                making.task.cancel()

    async def settle(self, timeout_s: float) -> None:
        """Wait for what is being made, at most for a time [s]."""
        if self._making:
            await asyncio.wait([m.task for m in self._making.values()], timeout=timeout_s)

    async def close(self) -> None:
        """Wait for what ended with the planner; jobs are done after the next start."""
        if self._making:
            await asyncio.wait([making.task for making in self._making.values()])
        await self._kept()

    def under_way(self, plan_id: str) -> Making | None:
        """Return a plan that is being made, or None."""
        return self._making.get(plan_id)

    async def failure(self, plan_id: str) -> dict[str, Any] | None:
        """Return the problem document of a job that failed, or None."""
        problem = await self._store.problem(plan_id)
        return None if problem is None else json.loads(problem)

    async def cancel(self, plan_id: str) -> None:
        """Stop a job, or forget a plan; who waits for the same plan gets it all the same.

        Raises:
            PlanNotFound: There is none.
        """
        recent = self._recent.delete(plan_id)
        if (keeping := self._keeping.get(plan_id)) is not None:
            await asyncio.wait([keeping])
        making = self._making.get(plan_id)
        kept = await self._store.delete(plan_id)
        if not (recent or kept or making):
            raise PlanNotFound(id=plan_id)
        if making is not None:
            making.accepted = False
            self._drop_unwanted(making)

    def _begin(self, job: Job, *, patient: bool) -> Making:
        making = Making(job)
        self._making[job.plan_id] = making
        making.task = asyncio.create_task(self._work(making, patient))
        making.task.add_done_callback(lambda _: self._ended(making))
        return making

    def _ended(self, making: Making) -> None:
        self._forget(making)
        making.end()

    def _forget(self, making: Making) -> None:
        if self._making.get(making.job.plan_id) is making:
            del self._making[making.job.plan_id]

    async def _join(self, making: Making) -> Answer:
        making.waiters += 1
        try:
            return await asyncio.shield(making.task)
        finally:
            making.waiters -= 1
            self._drop_unwanted(making)

    def _drop_unwanted(self, making: Making) -> None:
        if not making.waiters and not making.accepted:
            self._forget(making)  # who asks for it from now on begins anew
            making.task.cancel()

    async def _work(self, making: Making, patient: bool) -> Answer:
        job = making.job
        try:
            answer = await self._planner.run(
                job.kind,
                job.document,
                robot=job.robot,
                limit_s=job.budget_s,
                progress=making.progress,
                patient=patient,
            )
            await self._begin_to_keep(job.plan_id, answer.document)
            return answer
        except IkplanError as error:
            making.problem = plain(error.to_problem())
            # A job that only had no worker, as when the service stops, is done later.
            if making.accepted and not isinstance(error, ServiceUnavailable):
                await self._keep_failure(making)
            raise
        except Exception:
            _log.exception("plan %s failed", job.plan_id)
            making.problem = http_problem(500, "an unexpected fault of the service")
            if making.accepted:
                await self._keep_failure(making)
            raise

    async def _begin_to_keep(self, plan_id: str, document: bytes) -> None:
        """Keep a plan while it is answered; wait only for a store that falls behind."""
        if len(self._keeping) >= _KEEPING:
            await self._kept()
        self._recent.put(plan_id, document)
        if plan_id not in self._keeping:
            self._keeping[plan_id] = asyncio.create_task(self._keep(plan_id, document))

    async def _kept(self) -> None:
        if self._keeping:
            await asyncio.wait(self._keeping.values())

    async def _keep(self, plan_id: str, document: bytes) -> None:
        try:
            await self._store.put(plan_id, document)
            self._recent.delete(plan_id)  # from here on the bounds of the store hold for it
        except StoreFault as error:
            _log.error("plan %s could not be kept: %s", plan_id, error)
        finally:
            del self._keeping[plan_id]

    async def _keep_failure(self, making: Making) -> None:
        with contextlib.suppress(StoreFault):
            await self._store.fail(making.job.plan_id, json.dumps(making.problem).encode())
