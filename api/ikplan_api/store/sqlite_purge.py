"""Deletion of plans that exceed the bounds of the SQLite file, in slices, and its shrinking."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
import sqlite3
import time

from ikplan_api.cancelling import cancelled
from ikplan_api.store.plan_store import StoreFault
from ikplan_api.store.sqlite_file import SqliteFile

__all__ = ["SqlitePurge"]

_log = logging.getLogger("ikplan.service")

_SLICE = 32
"""Most plans that one statement deletes: other writes wait for some milliseconds at most."""
_AUDIT_SLICE = 256
_MOST_AUDIT = 1_000_000
"""Most actions of the audit that are stored."""
_GIVEN_BACK = 256 * 1024
"""Most that one statement gives back [bytes]."""
_FREE_SHARE = 1 / 8
"""Share of unused pages in the file from which it is shortened."""
_LEAST_FREE = 1024 * 1024
"""What may be unused in any file [bytes]."""
_PAUSE_S = 0.002
"""Pause between two slices, in which waiting writes have their turn [s]."""
_AGE_EVERY_S = 60.0
_RETRY_S = 60.0
_SURPLUS = """
DELETE FROM plans WHERE id IN (
    SELECT id FROM (
        SELECT id, bytes, SUM(bytes) OVER oldest AS freed, ROW_NUMBER() OVER oldest AS place
        FROM (SELECT id, used, bytes FROM plans ORDER BY used, id LIMIT ?)
        WINDOW oldest AS (ORDER BY used, id)
    ) WHERE freed - bytes < ? OR place <= ?
) RETURNING id
"""
_OLD = "DELETE FROM plans WHERE id IN (SELECT id FROM plans WHERE made < ? LIMIT ?) RETURNING id"
_OLD_AUDIT = """
DELETE FROM audit WHERE place IN (
    SELECT place FROM audit
    WHERE time < ? OR place <= (SELECT max(place) FROM audit) - ? ORDER BY place LIMIT ?
) RETURNING place
"""


class SqlitePurge:
    """Keeps the plans of a file within its bounds.

    Args:
        file: The file.
        max_plans: Largest number of plans.
        max_bytes: Largest total size of the plans [bytes].
        max_age_s: Longest time that plans are stored [s].

    Attributes:
        sizes: Size of every stored plan by its scoped id [bytes]: most requests ask for new
            plans, and then no query is needed.
    """

    def __init__(self, file: SqliteFile, max_plans: int, max_bytes: int, max_age_s: float) -> None:
        self._file = file
        self._max_plans = max_plans
        self._max_bytes = max_bytes
        self._max_age_s = max_age_s
        self.sizes: dict[str, int] = {}
        self._bytes = 0
        self._needed = asyncio.Event()
        self._trimming = asyncio.Lock()
        self._purging: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Learn what is stored, and begin to purge in the background."""
        self.sizes = dict(await self._file.rows("SELECT id, bytes FROM plans", ()))
        self._bytes = sum(self.sizes.values())
        self._needed.set()
        self._purging = asyncio.create_task(self._purge())

    async def stop(self) -> None:
        """End the purge."""
        if self._purging is not None:
            await cancelled([self._purging])
            self._purging = None

    def added(self, key: str, size: int) -> None:
        """Count a stored plan."""
        self._bytes += size - self.sizes.get(key, 0)
        self.sizes[key] = size

    def removed(self, key: str) -> None:
        """Count a plan that was deleted."""
        self._bytes -= self.sizes.pop(key, 0)

    async def trim(self) -> bool:
        """Delete some of the surplus, least recently used first; return whether more is left.

        Raises:
            StoreFault: The write fails.
        """
        async with self._trimming:  # two at once would each delete what is too much
            over, over_bytes = len(self.sizes) - self._max_plans, self._bytes - self._max_bytes
            if over <= 0 and over_bytes <= 0:
                return False
            values = (_SLICE, max(0, over_bytes), over)
            deleted = await self._file.change(_SURPLUS, values)
            for (key,) in deleted:
                self.removed(key)
        left = len(self.sizes) > self._max_plans or self._bytes > self._max_bytes
        if left:
            self._needed.set()
        return left and bool(deleted)

    async def _purge(self) -> None:
        while True:
            # asyncio.wait_for of Python 3.11 loses a cancellation that meets what it waits for.
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(_AGE_EVERY_S):
                    await self._needed.wait()
            self._needed.clear()
            try:
                while await self.trim() or await self._forget_old() or await self._shrink():
                    await asyncio.sleep(_PAUSE_S)
            except (StoreFault, sqlite3.Error) as error:  # as of a full disk: tried again later
                _log.error("failed to delete surplus plans: %s", error)
                await asyncio.sleep(_RETRY_S)

    async def _forget_old(self) -> bool:
        oldest = time.time() - self._max_age_s
        deleted = await self._file.change(_OLD, (oldest, _SLICE))
        for (key,) in deleted:
            self.removed(key)
        audit = await self._file.change(_OLD_AUDIT, (oldest, _MOST_AUDIT, _AUDIT_SLICE))
        return len(deleted) == _SLICE or len(audit) == _AUDIT_SLICE

    async def _shrink(self) -> bool:
        """Give some unused pages back; return whether there are more."""
        (free,) = await self._file.row("PRAGMA freelist_count", ())
        (pages,) = await self._file.row("PRAGMA page_count", ())
        (size,) = await self._file.row("PRAGMA page_size", ())
        if free <= max(_LEAST_FREE // size, math.ceil(_FREE_SHARE * pages)):
            return False
        await self._file.change(f"PRAGMA incremental_vacuum({_GIVEN_BACK // size})", ())
        (left,) = await self._file.row("PRAGMA freelist_count", ())
        return bool(left < free)  # a file that cannot shrink stays as it is
