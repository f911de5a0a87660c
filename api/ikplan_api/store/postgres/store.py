"""What one replica has of the database."""

from __future__ import annotations

import asyncio
import logging
import os
import random
import socket
import uuid
from collections.abc import Callable
from typing import Any, NamedTuple

from ikplan_api.cancelling import cancelled
from ikplan_api.store.plan_store import AuditRow, StoreFault
from ikplan_api.store.postgres.changes import Changes
from ikplan_api.store.postgres.database import Database
from ikplan_api.store.postgres.objects import ObjectStore
from ikplan_api.store.postgres.plans import PostgresPlans
from ikplan_api.store.postgres.queue import Depth, PostgresQueue

__all__ = ["PostgresBounds", "PostgresStore"]

_log = logging.getLogger("ikplan.service")

_AUDIT = """
SELECT place, extract(epoch FROM time)::float8, owner, action, subject, robot, replica, attempt
FROM audit WHERE (%(owner)s::text IS NULL OR owner = %(owner)s)
    AND (%(before)s::bigint IS NULL OR place < %(before)s)
ORDER BY place DESC LIMIT %(limit)s
"""
_TIDY_S = 20.0
_DEPTH_S = 2.0


class PostgresBounds(NamedTuple):
    """How much is stored.

    Attributes:
        max_plans: Largest number of plans.
        max_bytes: Largest total size of the plans in JSON [bytes].
        max_age_s: Longest time that plans, failures and the audit are stored [s].
        object_bytes: Size of a compressed plan from which it is in the object store [bytes].
    """

    max_plans: int
    max_bytes: int
    max_age_s: float
    object_bytes: int


class PostgresStore:
    """Plans, jobs, robots and scenes of all replicas.

    Args:
        url: Address of the database.
        bounds: How much is stored.
        lease_s: Time for which a claim holds without being renewed [s].
        object_url: Where long plans are; empty: in the database, too.

    Attributes:
        replica: Name of this replica, another one after each start.
        plans: The finished plans.
        queue: The jobs.
        changes: What other replicas tell.
        depth: The length of the queue, some seconds old at most.
        up: Whether the database answered when it was last asked.
    """

    shared = False

    def __init__(
        self, url: str, bounds: PostgresBounds, *, lease_s: float, object_url: str = ""
    ) -> None:
        self.replica = f"{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex[:8]}"
        self.database = Database(url)
        objects = ObjectStore(object_url) if object_url else None
        self.plans = PostgresPlans(
            self.database,
            objects,
            bounds.object_bytes,
            bounds.max_plans,
            bounds.max_bytes,
            bounds.max_age_s,
        )
        self.queue = PostgresQueue(self.database, self.plans, self.replica, lease_s)
        self.changes = Changes(url, self._heard)
        self.depth = Depth()
        self.up = True
        self.on_change: Callable[[tuple[str, str] | None, dict[str, Any]], None] | None = None
        self._max_age_s = bounds.max_age_s
        self._tasks: list[asyncio.Task[None]] = []

    def check(self) -> None:
        """Check the address.

        Raises:
            InvalidRequest: It is not one.
        """
        self.database.check()

    async def open(self) -> None:
        """Connect, and begin to listen and to tidy up.

        Raises:
            InvalidRequest: The database cannot be reached or used.
        """
        await self.database.open()
        self.changes.start()
        self._tasks = [asyncio.create_task(self._tidy()), asyncio.create_task(self._measure())]

    async def close(self) -> None:
        """Close every connection."""
        await cancelled(self._tasks)
        self._tasks = []
        await self.changes.stop()
        await self.database.close()

    async def audit(self, owner: str | None, before: int | None, limit: int) -> list[AuditRow]:
        """Return what was done, the newest first."""
        rows = await self.database.rows(_AUDIT, {"owner": owner, "before": before, "limit": limit})
        return [AuditRow(*row) for row in rows]

    def _heard(self, key: tuple[str, str] | None, change: dict[str, Any]) -> None:
        if self.on_change is not None:
            self.on_change(key, change)

    async def _tidy(self) -> None:
        while True:
            # Replicas that start together do not tidy up together.
            await asyncio.sleep(_TIDY_S * (0.5 + random.random()))
            try:
                await self.queue.tidy(self._max_age_s)
                await self.plans.purge()
            except StoreFault as error:
                _log.error("failed to delete surplus plans: %s", error)

    async def _measure(self) -> None:
        while True:
            try:
                self.depth = await self.queue.depth()
                self.up = True
            except StoreFault:
                self.up = False
            await asyncio.sleep(_DEPTH_S)
