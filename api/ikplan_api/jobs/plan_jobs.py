"""Plan jobs: each request is planned once, however many clients wait for it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections.abc import Callable
from typing import Any

from ikplan.documents.json_text import json_ready
from ikplan.documents.status import PlanStatus
from ikplan.errors import (
    BudgetExceeded,
    IkplanError,
    PlanNotFound,
    ServiceUnavailable,
)
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.http.problems import http_problem
from ikplan_api.jobs.job_attempts import JobAttempts, given_up
from ikplan_api.jobs.plan_in_progress import PlanInProgress
from ikplan_api.jobs.request_identity import RequestIdentifier
from ikplan_api.store.owners import scoped
from ikplan_api.store.plan_query import ListedPlan, PlanQuery
from ikplan_api.store.plan_store import Job, PlanStore, StoreFault
from ikplan_api.store.recent_plans import RecentPlans
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.tasks import TaskResult

__all__ = ["PlanJobs"]

Key = tuple[str, str]
"""Owner and plan id of a job: equal requests of two owners are two jobs."""

_MAX_STORING = 8
"""Plans that may be returned before they are stored."""

_log = logging.getLogger("ikplan.service")


class PlanJobs:
    """Runs plan jobs: deduplicates, stores and cancels them.

    Args:
        planner: The planner.
        store: The store of plans and accepted jobs.
        max_budget_s: Upper limit of every time budget [s].
        quota: Returns the most accepted and unfinished jobs of an owner; None: no limit.
    """

    def __init__(
        self,
        planner: Planner,
        store: PlanStore,
        max_budget_s: float,
        quota: Callable[[str], int | None] = lambda _: None,
    ) -> None:
        self._planner = planner
        self._store = store
        self._quota = quota
        self._in_progress: dict[Key, PlanInProgress] = {}
        self._identifier = RequestIdentifier(planner, max_budget_s)
        # Plans that are not stored yet, and those that the store failed to store.
        self._recent = RecentPlans(max_plans=256, max_bytes=64 * 2**20)
        self._storing: dict[Key, asyncio.Task[None]] = {}
        self._stored = True
        self.ends: dict[str, int] = {}

    async def resume(self) -> None:
        """Start the jobs that were accepted before a restart, in their order."""
        for job in await self._store.pending():
            if (verdict := given_up(job)) is not None:
                _log.error("job %s: %s", job.plan_id, verdict)
                await self._store_failure(job, json_ready(verdict.to_problem()))
            elif _key(job) not in self._in_progress:
                self._start(job, wait_if_full=True).accepted = True

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

    async def find(self, plan_id: str, owner: str) -> bytes | None:
        """Return a finished plan, or None if it is not stored."""
        name = scoped(owner, plan_id)
        recent = self._recent.get(name)
        # It may have finished during the query.
        return recent or await self._store.get(plan_id, owner) or self._recent.get(name)

    async def run(self, job: Job, *, wait_if_full: bool = False) -> bytes:
        """Return a stored plan, join its job in progress, or start a new one.

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
            in_progress = self._in_progress.get(_key(job)) or self._start(
                job, wait_if_full=wait_if_full
            )
            try:
                return (await self._join(in_progress)).document
            except BudgetExceeded:
                # The joined job had a smaller budget; this one may suffice.
                if in_progress.job.budget_s >= job.budget_s:
                    raise

    async def accept(self, job: Job) -> PlanStatus:
        """Accept a job, which will run even if the service is killed before.

        Raises:
            ServiceUnavailable: The queue is full, or the store cannot write.
        """
        in_progress = self._in_progress.get(_key(job))
        if in_progress is None or not in_progress.accepted:
            if in_progress is None:
                self._planner.check_capacity()
            self._check_quota(job.owner)
            try:
                await self._store.accept(job)
            except StoreFault as error:
                _log.error("failed to store a job: %s", error)
                raise ServiceUnavailable(
                    "jobs cannot be stored now and are not accepted; send the request without "
                    "Prefer: respond-async to wait for the plan",
                    status_code=ServiceUnavailable.status,
                    retry_after_s=60.0,
                ) from error
            # Another request may have started it meanwhile.
            in_progress = self._in_progress.get(_key(job)) or self._start(job, wait_if_full=True)
            in_progress.accepted = True
            in_progress.attempts.save()
        return in_progress.status

    def _check_quota(self, owner: str) -> None:
        """Refuse a further job of an owner who has as many as it may have.

        Raises:
            ServiceUnavailable: It has.
        """
        most = self._quota(owner)
        owned = sum(p.accepted and p.job.owner == owner for p in self._in_progress.values())
        if most is not None and owned >= most:
            raise ServiceUnavailable(
                f"the key has {owned} unfinished jobs, as many as it may have; try again later",
                status_code=ServiceUnavailable.status,
                retry_after_s=5.0,
            )

    @property
    def depth(self) -> tuple[int, int]:
        """Number of jobs that wait for a worker, and of those that run."""
        states = [in_progress.status.state for in_progress in self._in_progress.values()]
        return states.count("queued"), states.count("running")

    @property
    def store_up(self) -> bool:
        """Whether the latest plan could be stored."""
        return self._stored

    def park_queued(self) -> None:
        """Cancel the accepted jobs that wait for a worker; they run after the next start."""
        for in_progress in list(self._in_progress.values()):
            if not in_progress.waiters and in_progress.status.state == "queued":
                in_progress.task.cancel()

    async def drain(self, timeout_s: float) -> None:
        """Wait until the jobs in progress end, at most ``timeout_s`` [s]."""
        if self._in_progress:
            await asyncio.wait([m.task for m in self._in_progress.values()], timeout=timeout_s)

    async def close(self) -> None:
        """Wait for the jobs that ended with the planner and for pending writes."""
        if self._in_progress:
            await asyncio.wait([in_progress.task for in_progress in self._in_progress.values()])
        await self._wait_until_stored()

    async def in_progress(self, plan_id: str, owner: str) -> PlanInProgress | None:
        """Return a plan in progress, or None."""
        return self._in_progress.get((owner, plan_id))

    async def list(self, query: PlanQuery) -> list[ListedPlan]:
        """Return stored plans and jobs, the newest first, one more than the limit if there are.

        Raises:
            StoreFault: The read fails.
        """
        await self._wait_until_stored()
        return await self._store.list(query)

    async def failure(self, plan_id: str, owner: str) -> dict[str, Any] | None:
        """Return the problem document of a failed job, or None."""
        problem = await self._store.problem(plan_id, owner)
        return None if problem is None else json.loads(problem)

    async def cancel(self, plan_id: str, owner: str) -> None:
        """Cancel a job or delete a plan; clients that wait for the same plan still receive it.

        Raises:
            PlanNotFound: No plan and no job has this id.
        """
        recent = self._recent.delete(scoped(owner, plan_id))
        if (keeping := self._storing.get((owner, plan_id))) is not None:
            await asyncio.wait([keeping])
        in_progress = self._in_progress.get((owner, plan_id))
        stored = await self._store.delete(plan_id, owner)
        if not (recent or stored or in_progress):
            raise PlanNotFound(id=plan_id)
        if in_progress is not None:
            in_progress.accepted = False
            self._cancel_if_abandoned(in_progress)

    def _start(self, job: Job, *, wait_if_full: bool) -> PlanInProgress:
        in_progress = PlanInProgress(job, JobAttempts(job, self._store))
        self._in_progress[_key(job)] = in_progress
        in_progress.task = asyncio.create_task(self._run(in_progress, wait_if_full))
        in_progress.task.add_done_callback(lambda _: self._ended(in_progress))
        return in_progress

    def _ended(self, in_progress: PlanInProgress) -> None:
        self._remove(in_progress)
        in_progress.end()
        end = in_progress.status.state
        self.ends[end] = self.ends.get(end, 0) + 1

    def _remove(self, in_progress: PlanInProgress) -> None:
        key = _key(in_progress.job)
        if self._in_progress.get(key) is in_progress:
            del self._in_progress[key]

    async def _join(self, in_progress: PlanInProgress) -> TaskResult:
        in_progress.waiters += 1
        try:
            return await asyncio.shield(in_progress.task)
        finally:
            in_progress.waiters -= 1
            self._cancel_if_abandoned(in_progress)

    def _cancel_if_abandoned(self, in_progress: PlanInProgress) -> None:
        if not in_progress.waiters and not in_progress.accepted:
            self._remove(in_progress)  # a later request starts a new job
            in_progress.task.cancel()

    async def _run(self, in_progress: PlanInProgress, wait_if_full: bool) -> TaskResult:
        job = in_progress.job
        try:
            result = await self._plan(in_progress, wait_if_full)
            await self._start_storing(job, result.document)
            return result
        except IkplanError as error:
            in_progress.problem = json_ready(error.to_problem())
            # A job that found no worker, as during a shutdown, stays accepted and runs later.
            if in_progress.accepted and not isinstance(error, ServiceUnavailable):
                await self._store_failure(job, in_progress.problem)
            raise
        except Exception:
            _log.exception("plan %s failed", job.plan_id)
            in_progress.problem = http_problem(500, "unexpected error in the service")
            if in_progress.accepted:
                await self._store_failure(job, in_progress.problem)
            raise

    async def _plan(self, in_progress: PlanInProgress, wait_if_full: bool) -> TaskResult:
        """Plan, in more than one attempt if a worker ends.

        Raises:
            IkplanError: The verdict.
        """
        job, attempts = in_progress.job, in_progress.attempts
        try:
            return await self._planner.run(
                job.kind,
                job.document,
                robot=job.robot,
                known=job.known,
                limit_s=job.budget_s,
                progress=in_progress.progress,
                wait_if_full=wait_if_full,
                attempts=attempts,
            )
        finally:
            await attempts.saved()

    async def _start_storing(self, job: Job, document: bytes) -> None:
        """Store a plan in the background; wait only if the store falls behind."""
        if len(self._storing) >= _MAX_STORING:
            await self._wait_until_stored()
        self._recent.put(scoped(job.owner, job.plan_id), document)
        if _key(job) not in self._storing:
            self._storing[_key(job)] = asyncio.create_task(self._store_plan(job, document))

    async def _wait_until_stored(self) -> None:
        if self._storing:
            await asyncio.wait(self._storing.values())

    async def _store_plan(self, job: Job, document: bytes) -> None:
        name = scoped(job.owner, job.plan_id)
        try:
            await self._store.put(
                job.plan_id, document, owner=job.owner, kind=job.kind, robot=job.robot_name
            )
            self._recent.delete(name)  # now subject to the bounds of the store
            self._stored = True
        except StoreFault as error:
            self._stored = False
            _log.error("failed to store plan %s: %s", name, error)
        finally:
            del self._storing[_key(job)]

    async def _store_failure(self, job: Job, problem: dict[str, Any]) -> None:
        with contextlib.suppress(StoreFault):
            await self._store.fail(job.plan_id, json.dumps(problem).encode(), job.owner)


def _key(job: Job) -> Key:
    return job.owner, job.plan_id
