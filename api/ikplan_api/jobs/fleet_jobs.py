"""Plan jobs of several replicas: one queue in PostgreSQL, workers in each replica."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import time
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from ikplan.documents.json_text import json_ready
from ikplan.documents.status import PlanStatus
from ikplan.errors import BudgetExceeded, IkplanError, PlanNotFound, ServiceUnavailable
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.http.problems import http_problem
from ikplan_api.jobs.fleet_run import FleetAttempts, FleetRun
from ikplan_api.jobs.fleet_watch import FleetWatch
from ikplan_api.jobs.job_attempts import given_up
from ikplan_api.jobs.request_identity import RequestIdentifier
from ikplan_api.store.plan_query import ListedPlan, PlanQuery
from ikplan_api.store.plan_store import Job, StoreFault
from ikplan_api.store.postgres.queue import Claim
from ikplan_api.store.postgres.store import PostgresStore
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.tasks import TaskResult

__all__ = ["FleetJobs"]

_log = logging.getLogger("ikplan.service")

_POLL_S = 0.4
"""Time after which an idle replica looks for jobs whose lease has ended [s]."""
_AGAIN_S = 0.5
"""Time between two attempts to reach the database [s]."""
_SETTLE_S = 60.0
"""Time for which the end of a job waits for the database [s]."""
_WAITING_S = 10.0
"""Time for which a waiting client's answer waits for the database [s]."""

T = TypeVar("T")
Key = tuple[str, str]


class FleetJobs:
    """Runs plan jobs of all replicas in the workers of this one.

    Args:
        planner: The planner.
        store: The store of all replicas.
        max_budget_s: Upper limit of every time budget [s].
        lease_s: Time for which a claim holds without being renewed [s].
        max_jobs: Most jobs that wait in all.
        quota: Returns the most accepted and unfinished jobs of an owner; None: no limit.
    """

    def __init__(
        self,
        planner: Planner,
        store: PostgresStore,
        max_budget_s: float,
        *,
        lease_s: float,
        max_jobs: int,
        quota: Callable[[str], int | None],
    ) -> None:
        self._planner = planner
        self._store = store
        self._queue = store.queue
        self._lease_s = lease_s
        self._max_jobs = max_jobs
        self._quota = quota
        self._identifier = RequestIdentifier(planner, max_budget_s)
        self._runs: dict[Key, FleetRun] = {}
        self._settling: set[asyncio.Task[Any]] = set()
        self._wake = asyncio.Event()
        self._parked = False
        self._loops: list[asyncio.Task[None]] = []
        self.ends: dict[str, int] = {}

    async def resume(self) -> None:
        """Join the other replicas: run what waits, while a worker is idle."""
        self._store.on_change = self._heard
        self._loops = [asyncio.create_task(self._claiming()), asyncio.create_task(self._renewing())]

    @property
    def depth(self) -> tuple[int, int]:
        """Number of jobs of all replicas that wait for a worker, and of those that run."""
        return self._store.depth.queued, self._store.depth.running

    @property
    def store_up(self) -> bool:
        """Whether the database answered when it was last asked."""
        return self._store.up

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
        return await self._store.plans.get(plan_id, owner)

    async def run(self, job: Job, *, wait_if_full: bool = False) -> bytes:
        """Return a stored plan, join its job in any replica, or start a new one."""
        while True:
            if (document := await self.find(job.plan_id, job.owner)) is not None:
                return document
            run = self._runs.get((job.owner, job.plan_id))
            if run is None:
                if not wait_if_full:
                    self._planner.check_capacity()
                claim = await self._queue.begin(job)
                if claim is None:
                    await self._wait_elsewhere(job)
                    continue
                run = self._start(claim._replace(job=job), wait_if_full=wait_if_full)
            try:
                return (await self._join(run)).document
            except BudgetExceeded:
                # The joined job had a smaller budget; this one may suffice.
                if run.claim.job.budget_s >= job.budget_s:
                    raise

    async def _wait_elsewhere(self, job: Job) -> None:
        """Wait until another replica ended a job, or is gone.

        Raises:
            IkplanError: The verdict of a budget that is as large.
        """
        watched = await self.in_progress(job.plan_id, job.owner)
        if watched is not None:
            async for status in watched.watch():
                if status.state == "queued":
                    return  # given back: it can be run here

    async def accept(self, job: Job) -> PlanStatus:
        """Accept a job, which any replica will run.

        Raises:
            ServiceUnavailable: The queue is full, the owner has too many jobs, or the database
                does not answer.
        """
        try:
            depth = await self._queue.depth(job.owner)
            quota = self._quota(job.owner)
            if quota is not None and depth.owned >= quota:
                raise _full(f"the key has {depth.owned} unfinished jobs, as many as it may have")
            if depth.queued >= self._max_jobs:
                raise _full(f"{depth.queued} jobs wait already")
            return await self._queue.accept(job)
        except StoreFault as error:
            _log.error("failed to store a job: %s", error)
            raise ServiceUnavailable(
                "jobs cannot be stored now and are not accepted; try again later",
                status_code=ServiceUnavailable.status,
                retry_after_s=error.retry_after_s,
            ) from error

    async def in_progress(self, plan_id: str, owner: str) -> FleetWatch | None:
        """Return a plan in progress in any replica, or None."""
        row = await self._queue.look(plan_id, owner)
        if row is None or row.status.ended:
            return None
        return FleetWatch(self._store, (owner, plan_id), row)

    async def list(self, query: PlanQuery) -> list[ListedPlan]:
        """Return stored plans and jobs, the newest first, one more than the limit if there are."""
        return await self._store.plans.list(query)

    async def failure(self, plan_id: str, owner: str) -> dict[str, Any] | None:
        """Return the problem document of a failed job, or None."""
        row = await self._queue.look(plan_id, owner)
        return None if row is None or row.problem is None else json.loads(row.problem)

    async def cancel(self, plan_id: str, owner: str) -> None:
        """Cancel a job of any replica, or delete a plan.

        Raises:
            PlanNotFound: No plan and no job has this id.
        """
        if not await self._queue.delete(plan_id, owner):
            raise PlanNotFound(id=plan_id)

    def park_queued(self) -> None:
        """Claim no more jobs; other replicas do."""
        self._parked = True
        self._wake.set()

    async def drain(self, timeout_s: float) -> None:
        """Wait until the jobs in progress end, at most ``timeout_s`` [s]."""
        if self._runs:
            await asyncio.wait([run.task for run in self._runs.values()], timeout=timeout_s)

    async def close(self) -> None:
        """Wait for the jobs that ended with the planner, and leave the other replicas."""
        self._parked = True
        if self._runs:
            await asyncio.wait([run.task for run in self._runs.values()])
        if self._settling:
            await asyncio.wait(set(self._settling))
        for loop in self._loops:
            loop.cancel()
        if self._loops:
            await asyncio.wait(self._loops)
        self._store.on_change = None

    def _heard(self, key: Key | None, change: dict[str, Any]) -> None:
        """Hear of a change that a replica made, this one included."""
        if key is None or change.get("state") == "queued":
            self._wake.set()
        elif change.get("state") == "cancelled" and (run := self._runs.get(key)) is not None:
            self._settle_later(self._check(run))

    async def _check(self, run: FleetRun) -> None:
        """Stop a job that was cancelled: what was heard may be of an earlier claim of it."""
        if not await self._settle(lambda: self._queue.renew(run.claim)):
            self._lost(run)

    def _lost(self, run: FleetRun) -> None:
        """Stop a job that is no longer this replica's, unless clients here wait for it."""
        run.held = run.accepted = False
        if not run.waiters:
            run.task.cancel()

    async def _claiming(self) -> None:
        expired = time.monotonic()
        while not self._parked:
            self._wake.clear()
            try:
                if time.monotonic() >= expired and self._idle:
                    expired = time.monotonic() + _POLL_S
                    while self._idle and await self._claim(expired=True):
                        pass
                while self._idle and await self._claim(expired=False):
                    pass
            except StoreFault as error:
                _log.warning("no job can be claimed now: %s", error)
                await asyncio.sleep(_AGAIN_S)
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._wake.wait(), _POLL_S)

    @property
    def _idle(self) -> bool:
        """Whether a worker would begin a job at once."""
        load = self._planner.load
        busy = load.running + load.queued
        return not self._parked and self._planner.ready and busy < load.workers

    async def _claim(self, *, expired: bool) -> bool:
        claim = await self._queue.claim(expired=expired)
        if claim is None:
            return False
        # The claims before, each of which began it.
        begun = claim.job._replace(attempts=claim.attempt - 1)
        if (verdict := given_up(begun)) is not None:
            _log.error("job %s: %s", claim.job.plan_id, verdict)
            await self._fail(claim, json_ready(verdict.to_problem()))
            return True
        self._start(claim, wait_if_full=True)
        await asyncio.sleep(0)  # it counts as the planner's load from now on
        return True

    async def _renewing(self) -> None:
        while True:
            await asyncio.sleep(self._lease_s / 4)
            for run in list(self._runs.values()):
                try:
                    if run.held and not await self._queue.renew(run.claim):
                        _log.warning("job %s is no longer this replica's", run.claim.job.plan_id)
                        self._lost(run)
                except StoreFault as error:
                    _log.warning("no lease can be renewed now: %s", error)
                    break

    def _start(self, claim: Claim, *, wait_if_full: bool) -> FleetRun:
        run = FleetRun(claim)
        self._runs[run.key] = run
        run.task = asyncio.create_task(self._run(run, wait_if_full))
        run.task.add_done_callback(lambda _: self._ended(run))
        return run

    def _ended(self, run: FleetRun) -> None:
        if self._runs.get(run.key) is run:
            del self._runs[run.key]
        if not run.task.cancelled():
            run.task.exception()  # told to those who wait; there may be none
        self._wake.set()

    async def _join(self, run: FleetRun) -> TaskResult:
        run.waiters += 1
        try:
            return await asyncio.shield(run.task)
        finally:
            run.waiters -= 1
            if not run.waiters and not run.task.done():
                self._settle_later(self._abandon(run))

    async def _abandon(self, run: FleetRun) -> None:
        """Stop a job that nobody waits for any more, unless it was accepted meanwhile."""
        gone = not run.held or await self._settle(lambda: self._queue.abandon(run.claim))
        if gone and not run.waiters:
            run.held = False
            run.task.cancel()

    async def _run(self, run: FleetRun, wait_if_full: bool) -> TaskResult:
        claim = run.claim
        reporting = asyncio.create_task(run.report(self._queue))
        try:
            result = await self._plan(run, wait_if_full)
        except asyncio.CancelledError:
            if run.held:
                self._settle_later(self._settle(lambda: self._queue.release(claim)))
            raise
        except ServiceUnavailable:
            # No worker, as during a shutdown: another replica runs it.
            await self._settle(lambda: self._queue.release(claim))
            raise
        except IkplanError as error:
            await self._fail(claim, json_ready(error.to_problem()))
            raise
        except Exception:
            _log.exception("plan %s failed", claim.job.plan_id)
            await self._fail(claim, http_problem(500, "unexpected error in the service"))
            raise
        finally:
            reporting.cancel()
        await self._finish(run, result.document)
        return result

    async def _plan(self, run: FleetRun, wait_if_full: bool) -> TaskResult:
        job = run.claim.job
        return await self._planner.run(
            job.kind,
            job.document,
            robot=job.robot,
            known=job.known,
            limit_s=job.budget_s,
            progress=run.progress,
            wait_if_full=wait_if_full,
            attempts=FleetAttempts(run),
        )

    async def _finish(self, run: FleetRun, document: bytes) -> None:
        job = run.claim.job
        within_s = _WAITING_S if run.waiters else _SETTLE_S
        held = await self._settle(lambda: self._queue.finish(run.claim, document), within_s)
        self._count("finished" if held else "late")
        if held:
            return
        _log.warning("plan %s: the end of a lost claim is refused", job.plan_id)
        if run.waiters:
            # Whoever has the job now makes the same plan.
            plan = await self._store.plans.prepare(
                job.plan_id, document, job.owner, job.kind, job.robot_name
            )
            await self._settle(lambda: self._store.plans.put(plan), within_s)

    async def _fail(self, claim: Claim, problem: dict[str, Any]) -> None:
        text = json.dumps(problem).encode()
        held = await self._settle(lambda: self._queue.fail(claim, text))
        self._count("failed" if held else "late")

    async def _settle(self, write: Callable[[], Awaitable[T]], within_s: float = _SETTLE_S) -> T:
        """Write, again and again while the database does not answer.

        Raises:
            StoreFault: It does not for too long.
        """
        deadline = time.monotonic() + within_s
        while True:
            try:
                return await write()
            except StoreFault as error:
                if time.monotonic() > deadline:
                    raise
                _log.warning("the database does not answer now: %s", error)
                await asyncio.sleep(_AGAIN_S)

    def _settle_later(self, writing: Awaitable[Any]) -> None:
        """Write in the background."""
        task = asyncio.ensure_future(writing)
        self._settling.add(task)
        task.add_done_callback(self._settled)

    def _settled(self, task: asyncio.Future[Any]) -> None:
        self._settling.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            _log.error("failed to give a job back, its lease will end: %s", error)

    def _count(self, end: str) -> None:
        self.ends[end] = self.ends.get(end, 0) + 1


def _full(why: str) -> ServiceUnavailable:
    return ServiceUnavailable(
        f"{why}; try again later", status_code=ServiceUnavailable.status, retry_after_s=5.0
    )
