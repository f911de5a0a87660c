"""Plans and jobs in a SQLite file, so that they survive a restart."""

from __future__ import annotations

import contextlib
import json
import logging
import time
from typing import Any

from ikplan_api.store.owners import EVERYONE, scoped, unscoped
from ikplan_api.store.plan_query import ListedPlan, PlanQuery
from ikplan_api.store.plan_store import AuditRow, Job, StoreFault
from ikplan_api.store.sqlite_file import IN_MEMORY, SqliteFile
from ikplan_api.store.sqlite_purge import SqlitePurge

__all__ = ["IN_MEMORY", "SqlitePlanStore"]

_log = logging.getLogger("ikplan.service")

_OLD_FAILURES = "DELETE FROM jobs WHERE problem IS NOT NULL AND accepted < ?"
_DELETED = """
INSERT INTO audit (time, owner, action, subject, robot) VALUES (?, ?, 'deleted', ?, '')
"""
_AUDIT = """
SELECT place, time, owner, action, subject, robot FROM audit
WHERE (:owner IS NULL OR owner = :owner) AND (:before IS NULL OR place < :before)
ORDER BY place DESC LIMIT :limit
"""
_LIST = """
SELECT id, outcome, kind, robot, time, bytes, problem FROM (
    SELECT id, 'finished' AS outcome, kind, robot, made AS time, bytes, NULL AS problem, owner
    FROM plans WHERE made >= :oldest
    UNION ALL
    SELECT id, CASE WHEN problem IS NULL THEN 'unfinished' ELSE 'failed' END, kind,
        robot_name, accepted, NULL, problem, owner
    FROM jobs
) WHERE owner = :owner AND {where} ORDER BY time DESC, id DESC LIMIT :limit
"""


class SqlitePlanStore(SqliteFile):
    """Keeps plans and jobs in one file, bounded in number, size and age.

    The service locks the file while it runs.

    Args:
        path: The file, created with its folders if missing; ``":memory:"``: no file.
        max_plans: Largest number of plans.
        max_bytes: Largest total size of the plans [bytes]; a larger plan is not stored.
        max_age_s: Longest time that plans and failures are stored [s].
        replace_damaged: Whether a damaged file is set aside and a new one started.
    """

    def __init__(
        self,
        path: str,
        max_plans: int,
        max_bytes: int,
        max_age_s: float,
        *,
        replace_damaged: bool = False,
    ) -> None:
        super().__init__(path, replace_damaged=replace_damaged)
        self._max_plans = max_plans
        self._max_bytes = max_bytes
        self._max_age_s = max_age_s
        self._purge = SqlitePurge(self, max_plans, max_bytes, max_age_s)

    async def open(self) -> None:
        """Open the file, and begin to delete what exceeds the bounds.

        Raises:
            InvalidRequest: The file cannot be created, written or locked.
        """
        await super().open()
        try:
            await self._purge.start()
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """Close the file."""
        await self._purge.stop()
        await super().close()

    async def put(
        self,
        plan_id: str,
        document: bytes,
        *,
        owner: str = EVERYONE,
        kind: str = "plan",
        robot: str = "",
    ) -> None:
        """Store a plan and evict the least recently used ones."""
        key, size = scoped(owner, plan_id), len(document)
        if size > self._max_bytes or not self._max_plans:
            await self.change("DELETE FROM jobs WHERE id = ?", (key,))
            return
        await self.change(
            "INSERT INTO kept (id, made, document, owner, kind, robot) VALUES (?, ?, ?, ?, ?, ?)",
            (key, time.time(), document, owner, kind, robot),
        )
        self._purge.added(key, size)
        try:
            await self._purge.trim()
        except StoreFault as error:  # the next plan tries it again
            _log.error("failed to delete surplus plans: %s", error)

    async def get(self, plan_id: str, owner: str = EVERYONE) -> bytes | None:
        """Return a plan, or None if it is not stored."""
        key = scoped(owner, plan_id)
        if key not in self._purge.sizes:
            return None
        now = time.time()
        try:
            row = await self.row(
                "SELECT document FROM kept WHERE id = ? AND made >= ?",
                (key, now - self._max_age_s),
            )
        except StoreFault as error:  # then it is planned again
            _log.error("failed to read plan %s: %s", plan_id, error)
            return None
        if row is None:
            return None
        with contextlib.suppress(StoreFault):  # reading still works
            await self.change("UPDATE plans SET used = ? WHERE id = ?", (now, key))
        return bytes(row[0])

    async def accept(self, job: Job) -> None:
        """Store a job and delete an earlier failure of the same request."""
        await self.change(
            "INSERT OR REPLACE INTO jobs (id, kind, document, robot, budget_s, accepted, owner, "
            "robot_name) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
            (
                *(scoped(job.owner, job.plan_id), job.kind, job.document, job.robot, job.budget_s),
                *(time.time(), job.owner, job.robot_name),
            ),
        )

    async def count_attempts(self, plan_id: str, attempts: int, owner: str = EVERYONE) -> None:
        """Store how often a worker began an unfinished job."""
        await self.change(
            "INSERT OR REPLACE INTO attempts SELECT id, ? FROM jobs "
            "WHERE id = ? AND problem IS NULL",
            (attempts, scoped(owner, plan_id)),
        )

    async def fail(self, plan_id: str, problem: bytes, owner: str = EVERYONE) -> None:
        """Store the problem document of a failed job."""
        key = scoped(owner, plan_id)
        async with self.writing() as connection:
            await connection.execute("UPDATE jobs SET problem = ? WHERE id = ?", (problem, key))
            await connection.execute(_OLD_FAILURES, (time.time() - self._max_age_s,))

    async def problem(self, plan_id: str, owner: str = EVERYONE) -> bytes | None:
        """Return the problem document of a failed job, or None."""
        key = scoped(owner, plan_id)
        row = await self.row("SELECT problem FROM jobs WHERE id = ?", (key,))
        return None if row is None or row[0] is None else bytes(row[0])

    async def delete(self, plan_id: str, owner: str = EVERYONE) -> bool:
        """Delete a plan, a job and its failure; return whether any existed."""
        key, found = scoped(owner, plan_id), 0
        async with self.writing() as connection:
            for table in ("plans", "jobs"):
                statement = f"DELETE FROM {table} WHERE id = ?"
                async with connection.execute(statement, (key,)) as cursor:
                    found += cursor.rowcount
            if found:
                await connection.execute(_DELETED, (time.time(), owner, plan_id))
        self._purge.removed(key)
        return found > 0

    async def pending(self) -> list[Job]:
        """Return the unfinished jobs in the order of their acceptance."""
        query = (
            "SELECT id, kind, document, robot, budget_s, coalesce(begun, 0), owner, robot_name "
            "FROM jobs LEFT JOIN attempts USING (id) WHERE problem IS NULL ORDER BY place"
        )
        return [
            Job(unscoped(key), *row)._replace(attempts=begun, owner=owner, robot_name=robot_name)
            async for key, *row, begun, owner, robot_name in self._each(query)
        ]

    async def audit(self, owner: str | None, before: int | None, limit: int) -> list[AuditRow]:
        """Return what was done, the newest first."""
        rows = await self.rows(_AUDIT, {"owner": owner, "before": before, "limit": limit})
        return [AuditRow(*row) for row in rows]

    async def _each(self, query: str) -> Any:
        async with self._open_connection().execute(query) as cursor:
            async for row in cursor:
                yield row

    async def list(self, query: PlanQuery) -> list[ListedPlan]:
        """Return plans and jobs, the newest first, one more than the limit if there are more."""
        conditions: dict[str, Any] = {
            "robot = :robot": query.robot,
            "outcome = :outcome": query.outcome,
            "time >= :since": query.since,
            "time < :until": query.until,
        }
        asked = {text: value for text, value in conditions.items() if value is not None}
        values = {text.rpartition(":")[2]: value for text, value in asked.items()}
        where = list(asked)
        if query.after is not None:
            where.append("(time, id) < (:after_time, :after_id)")
            time_s, plan_id = query.after
            values |= {"after_time": time_s, "after_id": scoped(query.owner, plan_id)}
        values |= {
            "owner": query.owner,
            "limit": query.limit + 1,
            "oldest": time.time() - self._max_age_s,
        }
        rows = await self.rows(_LIST.format(where=" AND ".join(where) or "true"), values)
        return [
            ListedPlan._make((unscoped(key), *row, _type_of(problem)))
            for key, *row, problem in rows
        ]


def _type_of(problem: bytes | None) -> str | None:
    """Return the type of a problem document, if there is one."""
    return None if problem is None else str(json.loads(problem).get("type", "about:blank"))
