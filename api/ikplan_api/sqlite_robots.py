"""Uploaded robots in the file of the plans, so that they outlive the service."""

from __future__ import annotations

import contextlib
import json
import time

from ikplan_api.robot_store import StoredRobot
from ikplan_api.sqlite_store import SqliteStore
from ikplan_api.store import StoreFault

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
    """Keeps the robots used last, bounded in number and in size.

    Args:
        store: The open file.
        max_robots: Most robots kept.
        max_bytes: Size of all robots kept [bytes].
    """

    def __init__(self, store: SqliteStore, max_robots: int, max_bytes: int) -> None:
        self._store = store
        self._max_robots = max_robots
        self._max_bytes = max_bytes

    async def put(self, name: str, robot: StoredRobot) -> bool:
        """Keep a robot; those unused for longest make room for it."""
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
        """Return a robot, or None if it is not kept."""
        row = await self._store.row("SELECT document, info FROM robots WHERE name = ?", (name,))
        if row is None:
            return None
        with contextlib.suppress(StoreFault):  # it can still be read
            await self._store.change(
                "UPDATE robots SET used = ? WHERE name = ?", (time.time(), name)
            )
        return StoredRobot(bytes(row[0]), bytes(row[1]))

    async def delete(self, name: str) -> bool:
        """Forget a robot; return whether it was kept."""
        async with (
            self._store.writing() as connection,
            connection.execute("DELETE FROM robots WHERE name = ?", (name,)) as cursor,
        ):
            return cursor.rowcount > 0

    async def names(self) -> list[str]:
        """Return the names of all robots kept, sorted."""
        row = await self._store.row(
            "SELECT json_group_array(name) FROM (SELECT name FROM robots ORDER BY name)", ()
        )
        names: list[str] = json.loads(row[0])
        return names
