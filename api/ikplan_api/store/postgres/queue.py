"""The queue of jobs in PostgreSQL: claimed with a lease, finished by who has it, once.

A replica claims a job only if it has an idle worker. It renews the lease of a job while it runs.
Where it stops to, another replica takes the job over; what the first one still does with it is
refused, since each claim has a number of its own.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ikplan.documents.status import PlanStatus
from ikplan_api.store.owners import EVERYONE
from ikplan_api.store.plan_store import Job
from ikplan_api.store.postgres.database import Database
from ikplan_api.store.postgres.plans import PostgresPlans

__all__ = ["Claim", "Depth", "JobRow", "PostgresQueue"]

_TOLD = """
    SELECT {columns}, pg_notify('ikplan', json_build_object(
        'owner', owner, 'id', id, 'state', {state}::text, 'problem', {problem})::text)
    FROM {changed}
"""
_FENCE = """
    owner = %(owner)s AND id = %(id)s AND replica = %(replica)s AND attempt = %(attempt)s
    AND state = 'running'
"""
_JOB = "owner, id, kind, document, robot, robot_name, budget_s, attempt, accepted"
_VALUES = """
    %(owner)s, %(id)s, %(kind)s, %(document)s, %(robot)s, %(robot_name)s, %(budget_s)s
"""
_AUDIT = """
    INSERT INTO audit (owner, action, subject, robot, replica, attempt)
    SELECT owner, '{action}', id, robot_name, %(replica)s, attempt FROM {changed}
"""
_UNFINISHED = """
SELECT count(*) FILTER (WHERE state = 'queued'), count(*) FILTER (WHERE state = 'running'),
    count(*) FILTER (WHERE owner = %s AND accepted),
    coalesce(extract(epoch FROM now() - min(time) FILTER (WHERE state = 'queued')), 0)::float8
FROM jobs WHERE state <> 'failed'
"""
_ACCEPT = f"""
WITH added AS (
    INSERT INTO jobs AS old
        (owner, id, kind, document, robot, robot_name, budget_s, accepted, state)
    VALUES ({_VALUES}, true, 'queued')
    ON CONFLICT (owner, id) DO UPDATE SET
        accepted = true, problem = NULL, budget_s = greatest(old.budget_s, excluded.budget_s),
        state = CASE WHEN old.state = 'failed' THEN 'queued' ELSE old.state END,
        attempt = CASE WHEN old.state = 'failed' THEN 0 ELSE old.attempt END,
        time = CASE WHEN old.state = 'failed' THEN now() ELSE old.time END
    RETURNING owner, id, state, stage, done, total, robot_name, attempt
), logged AS ({_AUDIT.format(action="accepted", changed="added")})
{_TOLD.format(columns="state, stage, done, total", state="state", problem="NULL", changed="added")}
"""
_BEGIN = f"""
WITH claimed AS (
    INSERT INTO jobs AS old (owner, id, kind, document, robot, robot_name, budget_s, accepted,
        state, replica, attempt, lease_until)
    VALUES ({_VALUES}, false, 'running', %(replica)s, 1, now() + make_interval(secs => %(lease)s))
    ON CONFLICT (owner, id) DO UPDATE SET
        state = 'running', replica = excluded.replica, lease_until = excluded.lease_until,
        attempt = old.attempt + 1, problem = NULL, budget_s = excluded.budget_s,
        stage = NULL, done = 0, total = 0
    WHERE old.state <> 'running' OR old.lease_until < now()
    RETURNING owner, id, robot_name, attempt
), logged AS ({_AUDIT.format(action="claimed", changed="claimed")})
SELECT attempt FROM claimed
"""
_CLAIM = f"""
WITH next AS (
    SELECT owner, id FROM jobs WHERE {{which}} ORDER BY place FOR UPDATE SKIP LOCKED LIMIT 1
), claimed AS (
    UPDATE jobs SET state = 'running', replica = %(replica)s, attempt = attempt + 1,
        lease_until = now() + make_interval(secs => %(lease)s), stage = NULL, done = 0, total = 0
    FROM next WHERE jobs.owner = next.owner AND jobs.id = next.id
    RETURNING jobs.*
), logged AS ({_AUDIT.format(action="claimed", changed="claimed")})
SELECT {_JOB} FROM claimed
"""
_QUEUED = "state = 'queued'"
_EXPIRED = "state = 'running' AND lease_until < now() AND accepted"
_RENEW = f"""
UPDATE jobs SET lease_until = now() + make_interval(secs => %(lease)s) WHERE {_FENCE} RETURNING 1
"""
_PROGRESS = f"""
WITH changed AS (
    UPDATE jobs SET stage = %(stage)s, done = %(done)s, total = %(total)s WHERE {_FENCE}
    RETURNING owner, id, stage, done, total
)
SELECT pg_notify('ikplan', json_build_object('owner', owner, 'id', id, 'state', 'running',
    'stage', stage, 'done', done, 'total', total)::text) FROM changed
"""
_FINISH = f"""
WITH gone AS (
    DELETE FROM jobs WHERE owner = %(owner)s AND id = %(id)s AND replica = %(replica)s
        AND attempt = %(attempt)s AND state = 'running'
    RETURNING owner, id, robot_name, attempt
), logged AS ({_AUDIT.format(action="finished", changed="gone")}),
kept AS (
    INSERT INTO plans (owner, id, kind, robot, bytes, document, object)
    SELECT owner, id, %(kind)s, %(robot)s, %(bytes)s, %(document)s, %(object)s FROM gone
    ON CONFLICT (owner, id) DO NOTHING
)
{_TOLD.format(columns="1", state="'finished'", problem="NULL", changed="gone")}
"""
_FAIL = f"""
WITH failed AS (
    UPDATE jobs SET state = 'failed', problem = %(problem)s, lease_until = NULL
    WHERE {_FENCE} AND accepted RETURNING owner, id, robot_name, attempt
), gone AS (
    DELETE FROM jobs WHERE {_FENCE} AND NOT accepted RETURNING owner, id, robot_name, attempt
), ended AS (SELECT * FROM failed UNION ALL SELECT * FROM gone),
logged AS ({_AUDIT.format(action="failed", changed="ended")})
{_TOLD.format(columns="1", state="'failed'", problem="%(brief)s::json", changed="ended")}
"""
_RELEASE = f"""
WITH back AS (
    UPDATE jobs SET state = 'queued', replica = NULL, lease_until = NULL,
        attempt = greatest(0, attempt - 1), stage = NULL, done = 0, total = 0
    WHERE {_FENCE} AND accepted RETURNING owner, id, 'queued' AS state
), gone AS (
    DELETE FROM jobs WHERE {_FENCE} AND NOT accepted RETURNING owner, id, 'cancelled' AS state
), changed AS (SELECT * FROM back UNION ALL SELECT * FROM gone)
{_TOLD.format(columns="state", state="state", problem="NULL", changed="changed")}
"""
_DELETE = f"""
WITH plan AS (
    DELETE FROM plans WHERE owner = %(owner)s AND id = %(id)s
    RETURNING owner, id, robot AS robot_name, 0 AS attempt, object
), job AS (
    DELETE FROM jobs WHERE owner = %(owner)s AND id = %(id)s
    RETURNING owner, id, robot_name, attempt
), changed AS (
    SELECT owner, id, robot_name, attempt, object FROM plan
    UNION ALL SELECT owner, id, robot_name, attempt, NULL FROM job
), logged AS ({_AUDIT.format(action="deleted", changed="changed")})
{_TOLD.format(columns="object", state="'cancelled'", problem="NULL", changed="changed")}
"""
_STATUS = """
SELECT state, stage, done, total, problem FROM jobs
WHERE owner = %s AND id = %s AND (accepted OR lease_until > now())
"""
_ABANDONED = """
DELETE FROM jobs WHERE (NOT accepted AND lease_until < now() - interval '1 second')
    OR (state = 'failed' AND time < now() - make_interval(secs => %s))
"""
_BRIEF = 6000
"""Longest problem that a notification carries [bytes]; the database allows 8000 in all."""


class Claim(NamedTuple):
    """A job that a replica has, until its lease ends.

    Attributes:
        job: The job.
        attempt: Number of the claim of this job: what fences off the claims before.
        accepted: Whether it was accepted: it goes on without waiting clients.
    """

    job: Job
    attempt: int
    accepted: bool


class JobRow(NamedTuple):
    """What is known of an unfinished or failed job.

    Attributes:
        status: Its progress.
        problem: The problem document of a failed one.
    """

    status: PlanStatus
    problem: bytes | None


class Depth(NamedTuple):
    """How long the queue of all replicas is.

    Attributes:
        queued: Jobs that wait for a worker.
        running: Jobs that a worker runs.
        owned: Accepted and unfinished jobs of the owner asked for.
        oldest_s: How long the first of those that wait does so [s].
    """

    queued: int = 0
    running: int = 0
    owned: int = 0
    oldest_s: float = 0.0


class PostgresQueue:
    """The jobs of all replicas.

    Args:
        database: The database.
        plans: Where finished plans go.
        replica: Name of this replica, another one after each start.
        lease_s: Time for which a claim holds without being renewed [s].
    """

    def __init__(
        self, database: Database, plans: PostgresPlans, replica: str, lease_s: float
    ) -> None:
        self._database = database
        self._plans = plans
        self._replica = replica
        self._lease_s = lease_s

    async def depth(self, owner: str = EVERYONE) -> Depth:
        """Return how long the queue is."""
        row = await self._database.row(_UNFINISHED, (owner,))
        return Depth(*row) if row is not None else Depth()

    async def accept(self, job: Job) -> PlanStatus:
        """Put a job into the queue, unless it is there; return its progress."""
        row = await self._database.row(_ACCEPT, self._values(job))
        assert row is not None
        state, stage, done, total, _ = row
        return PlanStatus(id=job.plan_id, state=state, stage=stage, done=done, total=total)

    async def begin(self, job: Job) -> Claim | None:
        """Claim a request that a client waits for; None: another replica runs it."""
        row = await self._database.row(_BEGIN, self._values(job))
        return None if row is None else Claim(job, row[0], accepted=False)

    async def claim(self, *, expired: bool) -> Claim | None:
        """Claim the first job that waits, or one whose lease has ended; None: there is none."""
        query = _CLAIM.format(which=_EXPIRED if expired else _QUEUED)
        values = {"replica": self._replica, "lease": self._lease_s}
        row = await self._database.row(query, values)
        if row is None:
            return None
        owner, plan_id, kind, document, robot, robot_name, budget_s, attempt, accepted = row
        job = Job(plan_id, kind, document, robot, budget_s, owner=owner, robot_name=robot_name)
        return Claim(job, attempt, accepted)

    async def renew(self, claim: Claim) -> bool:
        """Extend the lease of a claim; return whether it still holds."""
        return bool(await self._database.rows(_RENEW, self._fence(claim)))

    async def progress(self, claim: Claim, stage: str, done: int, total: int) -> None:
        """Store and tell the progress of a job."""
        values = {"stage": stage, "done": done, "total": total}
        await self._database.rows(_PROGRESS, self._fence(claim) | values)

    async def finish(self, claim: Claim, document: bytes) -> bool:
        """Store the plan of a job; return whether the claim still held: else nothing is stored."""
        job = claim.job
        plan = await self._plans.prepare(job.plan_id, document, job.owner, job.kind, job.robot_name)
        held = bool(await self._database.rows(_FINISH, self._fence(claim) | plan))
        if not held:
            await self._plans.forget([plan["object"]])
            await self._refused(claim)
        return held

    async def _refused(self, claim: Claim) -> None:
        await self._database.rows(
            "INSERT INTO audit (owner, action, subject, robot, replica, attempt) "
            "VALUES (%(owner)s, 'late', %(id)s, %(robot)s, %(replica)s, %(attempt)s)",
            self._fence(claim) | {"robot": claim.job.robot_name},
        )

    async def fail(self, claim: Claim, problem: bytes) -> bool:
        """Store the problem of a job; return whether the claim still held."""
        brief = problem.decode() if len(problem) <= _BRIEF else None
        values = self._fence(claim) | {"problem": problem, "brief": brief}
        return bool(await self._database.rows(_FAIL, values))

    async def release(self, claim: Claim) -> bool:
        """Give a job back to the queue, or drop one that was not accepted; whether it went back."""
        rows = await self._database.rows(_RELEASE, self._fence(claim))
        return any(row[0] == "queued" for row in rows)

    async def abandon(self, claim: Claim) -> bool:
        """Drop a job that nobody waits for, unless it was accepted; return whether it is gone."""
        query = f"DELETE FROM jobs WHERE {_FENCE} AND NOT accepted RETURNING 1"
        return bool(await self._database.rows(query, self._fence(claim)))

    async def delete(self, plan_id: str, owner: str) -> bool:
        """Delete a plan, a job and its failure; return whether any existed."""
        values = {"owner": owner, "id": plan_id, "replica": self._replica}
        rows = await self._database.rows(_DELETE, values)
        await self._plans.forget([row[0] for row in rows])
        return bool(rows)

    async def look(self, plan_id: str, owner: str) -> JobRow | None:
        """Return what is known of a job; None: it is finished, or there is none."""
        row = await self._database.row(_STATUS, (owner, plan_id))
        if row is None:
            return None
        state, stage, done, total, problem = row
        status = PlanStatus(id=plan_id, state=state, stage=stage, done=done, total=total)
        return JobRow(status, problem)

    async def tidy(self, max_age_s: float) -> None:
        """Delete what was left behind: requests whose replica ended, and old failures."""
        await self._database.rows(_ABANDONED, (max_age_s,))
        old = "DELETE FROM audit WHERE time < now() - make_interval(secs => %s)"
        await self._database.rows(old, (max_age_s,))

    def _values(self, job: Job) -> dict[str, Any]:
        return {
            "owner": job.owner,
            "id": job.plan_id,
            "kind": job.kind,
            "document": job.document,
            "robot": job.robot,
            "robot_name": job.robot_name,
            "budget_s": job.budget_s,
            "replica": self._replica,
            "lease": self._lease_s,
        }

    def _fence(self, claim: Claim) -> dict[str, Any]:
        return {
            "owner": claim.job.owner,
            "id": claim.job.plan_id,
            "replica": self._replica,
            "attempt": claim.attempt,
            "lease": self._lease_s,
        }
