"""The SQLite file of the service: opened, upgraded, locked, written and read."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager
from typing import Any

import aiosqlite

from ikplan.errors import InvalidRequest
from ikplan_api.store.inspection import DamagedStore, NewerStore, inspect, set_aside
from ikplan_api.store.lock_holder import lock_holder
from ikplan_api.store.plan_store import StoreFault
from ikplan_api.store.sqlite_schema import ADDED, OPEN, SCHEMA, SHARED, UPGRADE, VERSION

__all__ = ["IN_MEMORY", "SqliteFile"]

IN_MEMORY = ":memory:"
"""The path that means: in memory, without a file."""

_SETTING = "IKPLAN_STORE_PATH"


class SqliteFile:
    """A file that one service uses at a time.

    Every write survives a kill of the service; a power failure can lose the last writes.

    Args:
        path: The file, created with its folders if missing; ``":memory:"``: no file.
        replace_damaged: Whether a damaged file is set aside and a new one started.
    """

    def __init__(self, path: str, *, replace_damaged: bool = False) -> None:
        self._path = path
        self._replace_damaged = replace_damaged
        self._connection: aiosqlite.Connection | None = None
        self._writing = asyncio.Lock()
        self._shared = False

    @property
    def shared(self) -> bool:
        """Whether all keys shared the file when it was begun."""
        return self._shared

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
        """Open the file, and bring it to the newest version.

        Raises:
            InvalidRequest: The file cannot be created, written or locked.
        """
        await asyncio.to_thread(self.check)
        self._connection = await aiosqlite.connect(self._path, isolation_level=None, timeout=1.0)
        try:
            await self._connection.executescript(OPEN)
            (version,) = await self.row("PRAGMA user_version", ())
            if version < VERSION:
                await self._connection.executescript(UPGRADE if version else SCHEMA)
            await self._connection.executescript(ADDED)
            fact = await self.row("SELECT value FROM facts WHERE name = ?", (SHARED,))
            self._shared = fact is not None
        except BaseException:
            await self.close()
            raise

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

    async def change(self, statement: str, values: Sequence[Any]) -> list[Any]:
        """Make one change; return the rows of its RETURNING clause.

        Raises:
            StoreFault: The write fails.
        """
        connection = self._open_connection()
        async with self._writing:
            try:
                return list(await connection.execute_fetchall(statement, values))
            except sqlite3.Error as error:
                raise StoreFault(str(error)) from error

    def _open_connection(self) -> aiosqlite.Connection:
        assert self._connection is not None, "the store is not open"
        return self._connection

    async def rows(self, query: str, values: Sequence[Any] | Mapping[str, Any]) -> list[Any]:
        """Return the rows of a query's result.

        Raises:
            StoreFault: The read fails.
        """
        try:
            return list(await self._open_connection().execute_fetchall(query, values))
        except sqlite3.Error as error:
            raise StoreFault(str(error)) from error

    async def row(self, query: str, values: Sequence[Any] | Mapping[str, Any]) -> Any:
        """Return the first row of a query's result, or None.

        Raises:
            StoreFault: The read fails.
        """
        return next(iter(await self.rows(query, values)), None)
