"""Uploaded robots in the SQLite file of the plans, so that they survive a restart."""

from __future__ import annotations

import contextlib
import json
import time

from ikplan_api.store.plan_store import StoreFault
from ikplan_api.store.robot_store import StoredRobot
from ikplan_api.store.sqlite_plans import SqlitePlanStore

__all__ = ["SqliteRobotStore"]

_SURPLUS = """
DELETE FROM robots WHERE name IN (
    SELECT name FROM (
        SELECT name, SUM(bytes) OVER newest AS total, ROW_NUMBER() OVER newest AS place
        FROM robots WINDOW newest AS (ORDER BY used DESC, rowid DESC)
    ) WHERE total > ? OR place > ?
)
"""


class SqliteRobotStore:
    """Keeps the most recently used robots, bounded in number and size.

    Args:
        store: The open plan store, whose file also holds the robots.
        max_robots: Largest number of robots.
        max_bytes: Largest total size [bytes].
    """

    def __init__(self, store: SqlitePlanStore, max_robots: int, max_bytes: int) -> None:
        self._store = store
        self._max_robots = max_robots
        self._max_bytes = max_bytes

    async def put(self, name: str, robot: StoredRobot) -> bool:
        """Store a robot and evict the least recently used ones."""
        size = len(robot.document) + len(robot.info)
        async with self._store.writing() as connection:
            delete = "DELETE FROM robots WHERE name = ?"
            async with connection.execute(delete, (name,)) as cursor:
                new = cursor.rowcount == 0
            await connection.execute(
                "INSERT INTO robots (name, bytes, used, document, info) VALUES (?, ?, ?, ?, ?)",
                (name, size, time.time(), *robot),
            )
            await connection.execute(_SURPLUS, (self._max_bytes, self._max_robots))
        return new

    async def get(self, name: str) -> StoredRobot | None:
        """Return a robot, or None if it is not stored."""
        row = await self._store.row("SELECT document, info FROM robots WHERE name = ?", (name,))
        if row is None:
            return None
        with contextlib.suppress(StoreFault):  # reading still works
            await self._store.change(
                "UPDATE robots SET used = ? WHERE name = ?", (time.time(), name)
            )
        return StoredRobot(bytes(row[0]), bytes(row[1]))

    async def delete(self, name: str) -> bool:
        """Delete a robot; return whether it was stored."""
        async with (
            self._store.writing() as connection,
            connection.execute("DELETE FROM robots WHERE name = ?", (name,)) as cursor,
        ):
            return cursor.rowcount > 0

    async def names(self) -> list[str]:
        """Return the names of all stored robots, sorted."""
        row = await self._store.row(
            "SELECT json_group_array(name) FROM (SELECT name FROM robots ORDER BY name)", ()
        )
        names: list[str] = json.loads(row[0])
        return names
