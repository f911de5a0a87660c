"""Connections to the database: opened, migrated, checked, and their failures told."""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import psycopg
import sqlalchemy
from alembic import command
from alembic.config import Config
from psycopg.conninfo import conninfo_to_dict
from psycopg_pool import AsyncConnectionPool

from ikplan.errors import InvalidRequest
from ikplan_api.store.plan_store import StoreFault

__all__ = ["RETRY_AFTER_S", "Database"]

_log = logging.getLogger("ikplan.service")

_SETTING = "IKPLAN_STORE_URL"
_MIGRATIONS = Path(__file__).with_name("migrations")
_CONNECTIONS = 8
"""Most connections of a replica, beside the one that listens."""
_WAIT_S = 3.0
"""Longest wait for a connection [s]: shorter than a client's patience."""
_START_S = 60.0
"""Time for the database to start, where a replica starts before it [s]."""
RETRY_AFTER_S = 2.0
"""Time after which a database that was restarted may be back [s]."""

# Alembic knows one migration at a time in a process.
_MIGRATING = threading.Lock()

Values = Sequence[Any] | Mapping[str, Any]


class Database:
    """The connections of one replica.

    Args:
        url: Address of the database, ``postgresql://...``.
    """

    def __init__(self, url: str) -> None:
        self.url = url
        self._pool: AsyncConnectionPool[psycopg.AsyncConnection[Any]] | None = None

    def check(self) -> None:
        """Check the address.

        Raises:
            InvalidRequest: It is not one.
        """
        try:
            conninfo_to_dict(self.url)
        except psycopg.Error as error:
            # The message of the error may contain the password.
            raise InvalidRequest(
                f"{_SETTING}: not an address of a database",
                field=_SETTING,
                allowed="postgresql://user@host:port/database",
            ) from error

    async def open(self) -> None:
        """Bring the database to the newest version, and connect to it.

        Raises:
            InvalidRequest: It cannot be reached or used.
        """
        await asyncio.to_thread(self._migrate)
        self._pool = AsyncConnectionPool(
            self.url,
            min_size=1,
            max_size=_CONNECTIONS,
            open=False,
            timeout=_WAIT_S,
            reconnect_timeout=_WAIT_S,
            # One that a restart of the database ended is replaced before it is used.
            check=AsyncConnectionPool.check_connection,
            kwargs={"autocommit": True, "application_name": "ikplan"},
        )
        await self._pool.open()

    def _migrate(self) -> None:
        deadline = time.monotonic() + _START_S
        engine = sqlalchemy.create_engine(
            "postgresql+psycopg://",
            creator=lambda: psycopg.connect(self.url, connect_timeout=5),
            poolclass=sqlalchemy.pool.NullPool,
        )
        while True:
            try:
                with _MIGRATING, engine.begin() as connection:
                    config = Config()
                    config.set_main_option("script_location", str(_MIGRATIONS))
                    config.attributes["connection"] = connection
                    command.upgrade(config, "head")
            except sqlalchemy.exc.OperationalError as error:
                if time.monotonic() > deadline:
                    raise self._unusable(error) from error
                _log.warning("the database cannot be reached yet")
                time.sleep(0.5)
            except (sqlalchemy.exc.SQLAlchemyError, psycopg.Error) as error:
                raise self._unusable(error) from error
            else:
                return

    def _unusable(self, error: Exception) -> InvalidRequest:
        cause = getattr(error, "orig", None) or error
        reason = str(cause).strip().splitlines()[0] if str(cause).strip() else type(cause).__name__
        return InvalidRequest(f"{_SETTING}: the database cannot be used: {reason}", field=_SETTING)

    async def close(self) -> None:
        """Close every connection."""
        if self._pool is not None:
            await self._pool.close()
            self._pool = None

    @asynccontextmanager
    async def connection(self) -> AsyncIterator[psycopg.AsyncConnection[Any]]:
        """Lend a connection.

        Raises:
            StoreFault: There is none now, or a statement fails.
        """
        assert self._pool is not None, "the store is not open"
        try:
            async with self._pool.connection() as connection:
                yield connection
        except psycopg.Error as error:
            raise StoreFault(str(error) or type(error).__name__, RETRY_AFTER_S) from error

    async def rows(self, query: str, values: Values = ()) -> list[tuple[Any, ...]]:
        """Run one statement; return its rows.

        Raises:
            StoreFault: It fails.
        """
        async with self.connection() as connection:
            cursor = await connection.execute(query.encode(), values)
            return await cursor.fetchall() if cursor.description is not None else []

    async def row(self, query: str, values: Values = ()) -> tuple[Any, ...] | None:
        """Run one statement; return its first row, or None.

        Raises:
            StoreFault: It fails.
        """
        return next(iter(await self.rows(query, values)), None)
