"""Plan jobs of several replicas: one queue in PostgreSQL, workers in each replica."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import time
from collections.abc import Callable
from typing import Any

from ikplan.documents.json_text import json_ready
from ikplan.documents.status import PlanStatus
from ikplan.errors import IkplanError, PlanNotFound, ServiceUnavailable
from ikplan_api.cancelling import cancelled
from ikplan_api.http.problems import http_problem
from ikplan_api.jobs.fleet_run import FleetAttempts, FleetRun
from ikplan_api.jobs.fleet_watch import FleetWatch
from ikplan_api.jobs.fleet_writes import AGAIN_S, SETTLE_S, FleetWrites
from ikplan_api.jobs.job_attempts import given_up
from ikplan_api.jobs.running_jobs import Key, RunningJobs
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
_WAITING_S = 10.0
"""Time for which a waiting client's answer waits for the database [s]."""


class FleetJobs(RunningJobs[FleetRun]):
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
        super().__init__(planner, max_budget_s, quota)
        self._store = store
        self._queue = store.queue
        self._lease_s = lease_s
        self._max_jobs = max_jobs
        self._writes = FleetWrites()
        self._wake = asyncio.Event()
        self._parked = False
        self._loops: list[asyncio.Task[None]] = []

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

    async def find(self, plan_id: str, owner: str) -> bytes | None:
        """Return a finished plan, or None if it is not stored."""
        return await self._store.plans.get(plan_id, owner)

    async def _begin(self, job: Job, wait_if_full: bool) -> FleetRun | None:
        if not wait_if_full:
            self._planner.check_capacity()
        claim = await self._queue.begin(job)
        if claim is None:
            await self._wait_elsewhere(job)
            return None
        return self._launch(FleetRun(claim._replace(job=job)), wait_if_full)

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
            self._check_quota(job.owner, depth.owned)
            if depth.queued >= self._max_jobs:
                raise self._full(f"{depth.queued} jobs wait already")
            return await self._queue.accept(job)
        except StoreFault as error:
            _log.error("failed to store a job: %s", error)
            raise self._not_stored("try again later", error.retry_after_s) from error

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

    async def close(self) -> None:
        """Wait for the jobs that ended with the planner, and leave the other replicas."""
        self._parked = True
        await self.drain(None)
        await self._writes.settled()
        await cancelled(self._loops)
        self._store.on_change = None

    def _heard(self, key: Key | None, change: dict[str, Any]) -> None:
        """Hear of a change that a replica made, this one included."""
        if key is None or change.get("state") == "queued":
            self._wake.set()
        elif change.get("state") == "cancelled" and (run := self._running.get(key)) is not None:
            self._writes.later(self._check(run))

    async def _check(self, run: FleetRun) -> None:
        """Stop a job that was cancelled: what was heard may be of an earlier claim of it."""
        if not await self._writes.settle(lambda: self._queue.renew(run.claim)):
            self._lost(run)

    def _lost(self, run: FleetRun) -> None:
        """Stop a job that is no longer this replica's, unless clients here wait for it."""
        if run.ending:  # its end is written, or refused
            return
        _log.warning("job %s is no longer this replica's", run.claim.job.plan_id)
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
                await asyncio.sleep(AGAIN_S)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(_POLL_S):
                    await self._wake.wait()

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
        self._launch(FleetRun(claim), wait_if_full=True)
        await asyncio.sleep(0)  # it counts as the planner's load from now on
        return True

    async def _renewing(self) -> None:
        while True:
            await asyncio.sleep(self._lease_s / 4)
            for run in list(self._running.values()):
                try:
                    if run.held and not await self._queue.renew(run.claim):
                        self._lost(run)
                except StoreFault as error:
                    _log.warning("no lease can be renewed now: %s", error)
                    break

    def _ended(self, run: FleetRun) -> None:
        self._remove(run)
        if not run.task.cancelled():
            run.task.exception()  # told to those who wait; there may be none
        self._wake.set()

    def _left(self, run: FleetRun) -> None:
        if not run.waiters and not run.task.done():
            self._writes.later(self._abandon(run))

    async def _abandon(self, run: FleetRun) -> None:
        """Stop a job that nobody waits for any more, unless it was accepted meanwhile."""
        gone = not run.held or await self._writes.settle(lambda: self._queue.abandon(run.claim))
        if gone and not run.waiters:
            run.held = False
            run.task.cancel()

    async def _run(self, run: FleetRun, wait_if_full: bool) -> TaskResult:
        claim = run.claim
        reporting = asyncio.create_task(run.report(self._queue))
        try:
            result = await self._plan(run, FleetAttempts(run), wait_if_full)
            run.ending = True
        except asyncio.CancelledError:
            if run.held:
                self._writes.later(self._writes.settle(lambda: self._queue.release(claim)))
            raise
        except ServiceUnavailable:
            # No worker, as during a shutdown: another replica runs it.
            await self._writes.settle(lambda: self._queue.release(claim))
            raise
        except IkplanError as error:
            run.ending = True
            await self._fail(claim, json_ready(error.to_problem()))
            raise
        except Exception:
            run.ending = True
            _log.exception("plan %s failed", claim.job.plan_id)
            await self._fail(claim, http_problem(500, "unexpected error in the service"))
            raise
        finally:
            await cancelled([reporting])
        await self._finish(run, result.document)
        return result

    async def _finish(self, run: FleetRun, document: bytes) -> None:
        job = run.claim.job
        within_s = _WAITING_S if run.waiters else SETTLE_S
        held = await self._writes.settle(lambda: self._queue.finish(run.claim, document), within_s)
        self._count("finished" if held else "late")
        if held:
            return
        _log.warning("plan %s: the end of a lost claim is refused", job.plan_id)
        if run.waiters:
            # Whoever has the job now makes the same plan.
            plan = await self._store.plans.prepare(
                job.plan_id, document, job.owner, job.kind, job.robot_name
            )
            await self._writes.settle(lambda: self._store.plans.put(plan), within_s)

    async def _fail(self, claim: Claim, problem: dict[str, Any]) -> None:
        text = json.dumps(problem).encode()
        held = await self._writes.settle(lambda: self._queue.fail(claim, text))
        self._count("failed" if held else "late")
