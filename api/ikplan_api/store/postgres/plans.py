"""Finished plans in PostgreSQL: compressed, long ones in an object store."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

import zstandard

from ikplan_api.store.owners import EVERYONE
from ikplan_api.store.plan_query import ListedPlan, PlanQuery
from ikplan_api.store.plan_store import StoreFault
from ikplan_api.store.postgres.database import RETRY_AFTER_S, Database
from ikplan_api.store.postgres.objects import ObjectStore

__all__ = ["PostgresPlans", "StoredPlan"]

_log = logging.getLogger("ikplan.service")

_LEVEL = 3
_LONG = 256 * 1024
"""Length from which compressing takes milliseconds, so that a thread does it [bytes]."""
_SLICE = 500
"""Most plans that one statement deletes."""
_INSERT = """
INSERT INTO plans (owner, id, kind, robot, bytes, document, object)
VALUES (%(owner)s, %(id)s, %(kind)s, %(robot)s, %(bytes)s, %(document)s, %(object)s)
ON CONFLICT (owner, id) DO NOTHING RETURNING 1
"""
_PUT = f"""
WITH gone AS (DELETE FROM jobs WHERE owner = %(owner)s AND id = %(id)s RETURNING owner, id),
told AS (
    SELECT pg_notify('ikplan', json_build_object(
        'owner', owner, 'id', id, 'state', 'finished')::text) FROM gone
),
kept AS ({_INSERT})
SELECT (SELECT count(*) FROM told), (SELECT count(*) FROM kept)
"""
_GET = """
WITH used AS (
    UPDATE plans SET used = now()
    WHERE owner = %(owner)s AND id = %(id)s AND used < now() - interval '1 minute'
)
SELECT document, object FROM plans
WHERE owner = %(owner)s AND id = %(id)s AND made > now() - make_interval(secs => %(age)s)
"""
_LIST = """
SELECT id, outcome, kind, robot, extract(epoch FROM time)::double precision, bytes, problem FROM (
    SELECT id, 'finished' AS outcome, kind, robot, made AS time, bytes, NULL AS problem, owner
    FROM plans WHERE owner = %(owner)s AND made > now() - make_interval(secs => %(age)s)
    UNION ALL
    SELECT id, CASE WHEN state = 'failed' THEN 'failed' ELSE 'unfinished' END, kind, robot_name,
        time, NULL, convert_from(problem, 'UTF8')::json ->> 'type', owner
    FROM jobs WHERE owner = %(owner)s
) AS listed WHERE {where} ORDER BY time DESC, id COLLATE "C" DESC LIMIT %(limit)s
"""
_OLD = """
DELETE FROM plans WHERE (owner, id) IN (
    SELECT owner, id FROM plans WHERE made < now() - make_interval(secs => %s) LIMIT %s
    FOR UPDATE SKIP LOCKED
) RETURNING object
"""
_SURPLUS = """
DELETE FROM plans WHERE (owner, id) IN (
    SELECT owner, id FROM plans ORDER BY used LIMIT %(slice)s FOR UPDATE SKIP LOCKED
) RETURNING object, bytes
"""


class StoredPlan(dict[str, Any]):
    """The columns of a plan that is to be stored."""


class PostgresPlans:
    """Keeps plans, bounded in number, size and age; the bounds are kept by a purge now and then.

    Args:
        database: The database.
        objects: Where long plans are; None: in the database, too.
        object_bytes: Size of a compressed plan from which it is in the object store [bytes].
        max_plans: Largest number of plans.
        max_bytes: Largest total size of the plans in JSON [bytes].
        max_age_s: Longest time that plans are stored [s].
    """

    def __init__(
        self,
        database: Database,
        objects: ObjectStore | None,
        object_bytes: int,
        max_plans: int,
        max_bytes: int,
        max_age_s: float,
    ) -> None:
        self._database = database
        self._objects = objects
        self._object_bytes = object_bytes
        self._max_plans = max_plans
        self._max_bytes = max_bytes
        self._max_age_s = max_age_s

    async def prepare(
        self, plan_id: str, document: bytes, owner: str, kind: str, robot: str
    ) -> StoredPlan:
        """Compress a plan, and put a long one into the object store.

        Raises:
            StoreFault: The object store cannot be written.
        """
        if len(document) > _LONG:
            packed = await asyncio.to_thread(_packed, document)
        else:
            packed = _packed(document)
        name = None
        if self._objects is not None and len(packed) > self._object_bytes:
            try:
                name = await self._objects.put(packed)
            except OSError as error:
                raise StoreFault(f"object store: {error}", RETRY_AFTER_S) from error
        return StoredPlan(
            owner=owner,
            id=plan_id,
            kind=kind,
            robot=robot,
            bytes=len(document),
            document=packed if name is None else None,
            object=name,
        )

    async def put(self, plan: StoredPlan) -> None:
        """Store a plan and delete the job that requested it; the first one stays.

        Raises:
            StoreFault: The write fails.
        """
        row = await self._database.row(_PUT, plan)
        if row is not None and not row[1]:
            await self.forget([plan["object"]])

    async def get(self, plan_id: str, owner: str = EVERYONE) -> bytes | None:
        """Return a plan, or None if it is not stored.

        Raises:
            StoreFault: The read fails.
        """
        values = {"owner": owner, "id": plan_id, "age": self._max_age_s}
        row = await self._database.row(_GET, values)
        if row is None:
            return None
        packed, name = row
        if packed is None:
            packed = await self._object(str(name))
            if packed is None:
                return None
        if len(packed) > _LONG // 2:
            return await asyncio.to_thread(_unpacked, packed)
        return _unpacked(packed)

    async def _object(self, name: str) -> bytes | None:
        if self._objects is None:
            raise StoreFault("a plan is in an object store, and none is set", RETRY_AFTER_S)
        try:
            return await self._objects.get(name)
        except OSError as error:
            raise StoreFault(f"object store: {error}", RETRY_AFTER_S) from error

    async def forget(self, names: list[str | None]) -> None:
        """Delete documents of the object store whose plans are gone."""
        for name in names:
            if name is not None and self._objects is not None:
                try:
                    await self._objects.delete(name)
                except OSError as error:
                    _log.error("failed to delete object %s: %s", name, error)

    async def list(self, query: PlanQuery) -> list[ListedPlan]:
        """Return plans and jobs, the newest first, one more than the limit if there are more.

        Raises:
            StoreFault: The read fails.
        """
        conditions: dict[str, Any] = {
            "robot = %(robot)s": query.robot,
            "outcome = %(outcome)s": query.outcome,
            "time >= to_timestamp(%(since)s)": query.since,
            "time < to_timestamp(%(until)s)": query.until,
        }
        where = [text for text, value in conditions.items() if value is not None] or ["true"]
        values = query._asdict() | {"limit": query.limit + 1, "age": self._max_age_s}
        del values["after"]
        if query.after is not None:
            where.append(
                '(extract(epoch FROM time)::double precision, id COLLATE "C") < '
                "(%(after_time)s::double precision, %(after_id)s::text)"
            )
            values["after_time"], values["after_id"] = query.after
        rows = await self._database.rows(_LIST.format(where=" AND ".join(where)), values)
        return [ListedPlan(*row) for row in rows]

    async def purge(self) -> None:
        """Delete what is too old or too much, in slices.

        Raises:
            StoreFault: The deletion fails.
        """
        while rows := await self._database.rows(_OLD, (self._max_age_s, _SLICE)):
            await self.forget([row[0] for row in rows])
        totals = await self._database.row("SELECT count(*), coalesce(sum(bytes), 0) FROM plans")
        assert totals is not None
        over, over_bytes = totals[0] - self._max_plans, int(totals[1]) - self._max_bytes
        while over > 0 or over_bytes > 0:
            most = min(_SLICE, max(over, 16 if over_bytes > 0 else 0))
            surplus = _SURPLUS
            rows = await self._database.rows(surplus, {"slice": most})
            if not rows:
                return
            await self.forget([row[0] for row in rows])
            over, over_bytes = over - len(rows), over_bytes - sum(row[1] for row in rows)


def _packed(document: bytes) -> bytes:
    return zstandard.ZstdCompressor(level=_LEVEL).compress(document)


def _unpacked(packed: bytes) -> bytes:
    return zstandard.ZstdDecompressor().decompress(packed)
