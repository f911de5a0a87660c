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
    IkplanError,
    PlanNotFound,
    ServiceUnavailable,
)
from ikplan_api.http.problems import http_problem
from ikplan_api.jobs.job_attempts import JobAttempts, given_up
from ikplan_api.jobs.plan_in_progress import PlanInProgress
from ikplan_api.jobs.running_jobs import Key, RunningJobs, key_of
from ikplan_api.store.owners import scoped
from ikplan_api.store.plan_query import ListedPlan, PlanQuery
from ikplan_api.store.plan_store import Job, PlanStore, StoreFault
from ikplan_api.store.recent_plans import RecentPlans
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.tasks import TaskResult

__all__ = ["PlanJobs"]

_MAX_STORING = 8
"""Plans that may be returned before they are stored."""

_log = logging.getLogger("ikplan.service")


class PlanJobs(RunningJobs[PlanInProgress]):
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
        super().__init__(planner, max_budget_s, quota)
        self._store = store
        # Plans that are not stored yet, and those that the store failed to store.
        self._recent = RecentPlans(max_plans=256, max_bytes=64 * 2**20)
        self._storing: dict[Key, asyncio.Task[None]] = {}
        self._stored = True

    async def resume(self) -> None:
        """Start the jobs that were accepted before a restart, in their order."""
        for job in await self._store.pending():
            if (verdict := given_up(job)) is not None:
                _log.error("job %s: %s", job.plan_id, verdict)
                await self._store_failure(job, json_ready(verdict.to_problem()))
            elif key_of(job) not in self._running:
                self._start(job, wait_if_full=True).accepted = True

    async def find(self, plan_id: str, owner: str) -> bytes | None:
        """Return a finished plan, or None if it is not stored."""
        name = scoped(owner, plan_id)
        recent = self._recent.get(name)
        # It may have finished during the query.
        return recent or await self._store.get(plan_id, owner) or self._recent.get(name)

    async def accept(self, job: Job) -> PlanStatus:
        """Accept a job, which will run even if the service is killed before.

        Raises:
            ServiceUnavailable: The queue is full, or the store cannot write.
        """
        in_progress = self._running.get(key_of(job))
        if in_progress is None or not in_progress.accepted:
            if in_progress is None:
                self._planner.check_capacity()
            owned = sum(p.accepted and p.job.owner == job.owner for p in self._running.values())
            self._check_quota(job.owner, owned)
            try:
                await self._store.accept(job)
            except StoreFault as error:
                _log.error("failed to store a job: %s", error)
                how = "send the request without Prefer: respond-async to wait for the plan"
                raise self._not_stored(how, 60.0) from error
            # Another request may have started it meanwhile.
            in_progress = self._running.get(key_of(job)) or self._start(job, wait_if_full=True)
            in_progress.accepted = True
            in_progress.attempts.save()
        return in_progress.status

    @property
    def depth(self) -> tuple[int, int]:
        """Number of jobs that wait for a worker, and of those that run."""
        states = [in_progress.status.state for in_progress in self._running.values()]
        return states.count("queued"), states.count("running")

    @property
    def store_up(self) -> bool:
        """Whether the latest plan could be stored."""
        return self._stored

    def park_queued(self) -> None:
        """Cancel the accepted jobs that wait for a worker; they run after the next start."""
        for in_progress in list(self._running.values()):
            if not in_progress.waiters and in_progress.status.state == "queued":
                in_progress.task.cancel()

    async def close(self) -> None:
        """Wait for the jobs that ended with the planner and for pending writes."""
        await self.drain(None)
        await self._wait_until_stored()

    async def in_progress(self, plan_id: str, owner: str) -> PlanInProgress | None:
        """Return a plan in progress, or None."""
        return self._running.get((owner, plan_id))

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
        in_progress = self._running.get((owner, plan_id))
        stored = await self._store.delete(plan_id, owner)
        if not (recent or stored or in_progress):
            raise PlanNotFound(id=plan_id)
        if in_progress is not None:
            in_progress.accepted = False
            self._left(in_progress)

    async def _begin(self, job: Job, wait_if_full: bool) -> PlanInProgress:
        return self._start(job, wait_if_full=wait_if_full)

    def _start(self, job: Job, *, wait_if_full: bool) -> PlanInProgress:
        return self._launch(PlanInProgress(job, JobAttempts(job, self._store)), wait_if_full)

    def _ended(self, in_progress: PlanInProgress) -> None:
        self._remove(in_progress)
        in_progress.end()
        self._count(in_progress.status.state)

    def _left(self, in_progress: PlanInProgress) -> None:
        if not in_progress.waiters and not in_progress.accepted:
            self._remove(in_progress)  # a later request starts a new job
            in_progress.task.cancel()

    async def _run(self, in_progress: PlanInProgress, wait_if_full: bool) -> TaskResult:
        job = in_progress.job
        try:
            try:
                result = await self._plan(in_progress, in_progress.attempts, wait_if_full)
            finally:
                await in_progress.attempts.saved()
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

    async def _start_storing(self, job: Job, document: bytes) -> None:
        """Store a plan in the background; wait only if the store falls behind."""
        if len(self._storing) >= _MAX_STORING:
            await self._wait_until_stored()
        self._recent.put(scoped(job.owner, job.plan_id), document)
        if key_of(job) not in self._storing:
            self._storing[key_of(job)] = asyncio.create_task(self._store_plan(job, document))

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
            del self._storing[key_of(job)]

    async def _store_failure(self, job: Job, problem: dict[str, Any]) -> None:
        with contextlib.suppress(StoreFault):
            await self._store.fail(job.plan_id, json.dumps(problem).encode(), job.owner)
