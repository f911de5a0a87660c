"""Plans and jobs in a SQLite file, so that they survive a restart."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
import sqlite3
import time
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from typing import Any

import aiosqlite

from ikplan.errors import InvalidRequest
from ikplan_api.store.inspection import DamagedStore, NewerStore, inspect, set_aside
from ikplan_api.store.lock_holder import lock_holder
from ikplan_api.store.plan_store import Job, StoreFault
from ikplan_api.store.sqlite_schema import ADDED, OPEN, SCHEMA, VERSION

__all__ = ["IN_MEMORY", "SqlitePlanStore"]

IN_MEMORY = ":memory:"
"""The path that means: in memory, without a file."""

_log = logging.getLogger("ikplan.service")

_SETTING = "IKPLAN_STORE_PATH"
_OLD_PLANS = "DELETE FROM plans WHERE made < ?"
_OLD_FAILURES = "DELETE FROM jobs WHERE problem IS NOT NULL AND accepted < ?"
_SURPLUS = """
DELETE FROM plans WHERE id IN (
    SELECT id FROM (
        SELECT id, SUM(bytes) OVER newest AS total, ROW_NUMBER() OVER newest AS place
        FROM plans WINDOW newest AS (ORDER BY used DESC, id DESC)
    ) WHERE total > ? OR place > ?
)
"""


_SLACK = 1 / 32
"""Fraction by which the bounds may be exceeded before the surplus is deleted."""


class SqlitePlanStore:
    """Keeps plans and jobs in one file, bounded in number, size and age.

    The service locks the file while it runs. Every write survives a kill of the service; a power
    failure can lose the last writes.

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
        self._path = path
        self._replace_damaged = replace_damaged
        self._max_plans = max_plans
        self._max_bytes = max_bytes
        self._max_age_s = max_age_s
        self._connection: aiosqlite.Connection | None = None
        self._writing = asyncio.Lock()
        # Stored since the last deletion of surplus; infinite: unknown.
        self._new_plans: float = math.inf
        self._new_bytes: float = math.inf
        # Ids of all stored plans and of some deleted ones: most requests ask for new plans, and
        # then no query is needed.
        self._ids: set[str] = set()

    def check(self) -> None:
        """Check that the file can be used.

        Raises:
            InvalidRequest: The file cannot be created, written or locked.
        """
        if self._path == IN_MEMORY:
            return
        try:
            try:
                inspect(self._path, VERSION)
            except DamagedStore:
                if not self._replace_damaged:
                    raise
                set_aside(self._path)
                inspect(self._path, VERSION)
        except DamagedStore as error:
            raise self._unusable(
                f"is damaged ({error}); set IKPLAN_STORE_DAMAGED=set-aside to rename it and start "
                "a new one, restore it from a copy, or name another file"
            ) from error
        except NewerStore as error:
            raise self._unusable(
                "was written by a newer version of this service; name another file"
            ) from error
        except (OSError, sqlite3.Error) as error:
            reason = getattr(error, "strerror", None) or str(error)
            if "locked" in reason:
                holder = lock_holder(self._path)
                reason = "another service uses it" + (f" (process {holder})" if holder else "")
            raise InvalidRequest(
                f"{_SETTING}: plans cannot be stored in {self._path}: {reason}; name another file, "
                f"or {IN_MEMORY} to keep them in memory",
                field=_SETTING,
                allowed=f"a file that can be written, or {IN_MEMORY}",
            ) from error

    def _unusable(self, why: str) -> InvalidRequest:
        return InvalidRequest(f"{_SETTING}: {self._path} {why}", field=_SETTING)

    async def open(self) -> None:
        """Open the file.

        Raises:
            InvalidRequest: The file cannot be created, written or locked.
        """
        await asyncio.to_thread(self.check)
        self._connection = await aiosqlite.connect(self._path, isolation_level=None, timeout=1.0)
        try:
            await self._connection.executescript(OPEN)
            (version,) = await self.row("PRAGMA user_version", ())
            if version < VERSION:
                # Plans of an older version are planned again on request.
                await self._connection.executescript(SCHEMA)
            await self._connection.executescript(ADDED)
            await self._learn_ids()
        except BaseException:
            await self.close()
            raise

    async def _learn_ids(self) -> None:
        before = set(self._ids)
        rows = await self._open_connection().execute_fetchall("SELECT id FROM plans")
        stored = {row[0] for row in rows}
        self._ids -= before - stored
        self._ids |= stored

    async def close(self) -> None:
        """Close the file."""
        if self._connection is not None:
            await self._connection.close()
            self._connection = None

    @asynccontextmanager
    async def writing(self) -> AsyncIterator[aiosqlite.Connection]:
        """Make several changes in one transaction.

        Raises:
            StoreFault: The write fails.
        """
        connection = self._open_connection()
        async with self._writing:
            try:
                await connection.execute("BEGIN IMMEDIATE")
                try:
                    yield connection
                    await connection.execute("COMMIT")
                except BaseException:
                    # SQLite rolls back by itself on some errors, such as a full disk.
                    if connection.in_transaction:
                        await connection.execute("ROLLBACK")
                    raise
            except sqlite3.Error as error:
                raise StoreFault(str(error)) from error

    async def change(self, statement: str, values: Sequence[Any]) -> None:
        """Make one change.

        Raises:
            StoreFault: The write fails.
        """
        connection = self._open_connection()
        async with self._writing:
            try:
                await connection.execute_fetchall(statement, values)
            except sqlite3.Error as error:
                raise StoreFault(str(error)) from error

    def _open_connection(self) -> aiosqlite.Connection:
        assert self._connection is not None, "the store is not open"
        return self._connection

    async def row(self, query: str, values: Sequence[Any]) -> Any:
        """Return the first row of a query's result, or None.

        Raises:
            StoreFault: The read fails.
        """
        try:
            rows = await self._open_connection().execute_fetchall(query, values)
        except sqlite3.Error as error:
            raise StoreFault(str(error)) from error
        return next(iter(rows), None)

    async def put(self, plan_id: str, document: bytes) -> None:
        """Store a plan and evict the least recently used ones."""
        now = time.time()
        new_plans, new_bytes = self._new_plans + 1, self._new_bytes + len(document)
        # A check at every plan would take time proportional to the number of plans.
        trim = new_plans > _SLACK * self._max_plans or new_bytes > _SLACK * self._max_bytes
        await self.change("INSERT INTO kept VALUES (?, ?, ?)", (plan_id, now, document))
        self._ids.add(plan_id)
        self._new_plans, self._new_bytes = new_plans, new_bytes
        if trim:
            try:
                await self.change(_OLD_PLANS, (now - self._max_age_s,))
                await self.change(_SURPLUS, (self._max_bytes, self._max_plans))
                await self._learn_ids()
            except (StoreFault, sqlite3.Error) as error:  # the next plan tries it again
                _log.error("failed to delete surplus plans: %s", error)
            else:
                self._new_plans, self._new_bytes = 0, 0

    async def get(self, plan_id: str) -> bytes | None:
        """Return a plan, or None if it is not stored."""
        if plan_id not in self._ids:
            return None
        now = time.time()
        try:
            row = await self.row(
                "SELECT document FROM kept WHERE id = ? AND made >= ?",
                (plan_id, now - self._max_age_s),
            )
        except StoreFault as error:  # then it is planned again
            _log.error("failed to read plan %s: %s", plan_id, error)
            return None
        if row is None:
            return None
        with contextlib.suppress(StoreFault):  # reading still works
            await self.change("UPDATE plans SET used = ? WHERE id = ?", (now, plan_id))
        return bytes(row[0])

    async def accept(self, job: Job) -> None:
        """Store a job and delete an earlier failure of the same request."""
        await self.change(
            "INSERT OR REPLACE INTO jobs (id, kind, document, robot, budget_s, accepted) "
            "VALUES (?, ?, ?, ?, ?, ?)",
            (job.plan_id, job.kind, job.document, job.robot, job.budget_s, time.time()),
        )

    async def count_attempts(self, plan_id: str, attempts: int) -> None:
        """Store how often a worker began an unfinished job."""
        await self.change(
            "INSERT OR REPLACE INTO attempts SELECT id, ? FROM jobs "
            "WHERE id = ? AND problem IS NULL",
            (attempts, plan_id),
        )

    async def fail(self, plan_id: str, problem: bytes) -> None:
        """Store the problem document of a failed job."""
        async with self.writing() as connection:
            await connection.execute("UPDATE jobs SET problem = ? WHERE id = ?", (problem, plan_id))
            await connection.execute(_OLD_FAILURES, (time.time() - self._max_age_s,))

    async def problem(self, plan_id: str) -> bytes | None:
        """Return the problem document of a failed job, or None."""
        row = await self.row("SELECT problem FROM jobs WHERE id = ?", (plan_id,))
        return None if row is None or row[0] is None else bytes(row[0])

    async def delete(self, plan_id: str) -> bool:
        """Delete a plan, a job and its failure; return whether any existed."""
        found = 0
        async with self.writing() as connection:
            for table in ("plans", "jobs"):
                statement = f"DELETE FROM {table} WHERE id = ?"
                async with connection.execute(statement, (plan_id,)) as cursor:
                    found += cursor.rowcount
        return found > 0

    async def pending(self) -> list[Job]:
        """Return the unfinished jobs in the order of their acceptance."""
        query = (
            "SELECT id, kind, document, robot, budget_s, coalesce(begun, 0) FROM jobs "
            "LEFT JOIN attempts USING (id) WHERE problem IS NULL ORDER BY place"
        )
        async with self._open_connection().execute(query) as cursor:
            return [Job(*row)._replace(attempts=begun) async for *row, begun in cursor]
