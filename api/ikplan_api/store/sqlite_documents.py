"""Uploaded robots and scenes in the SQLite file of the plans: they survive a restart."""

from __future__ import annotations

import contextlib
import json
import time
from typing import Literal

from ikplan_api.store.document_store import StoredDocument
from ikplan_api.store.plan_store import StoreFault
from ikplan_api.store.sqlite_plans import SqlitePlanStore

__all__ = ["SqliteDocumentStore", "Table"]

Table = Literal["robots", "scenes"]

_SURPLUS = """
DELETE FROM {table} WHERE name IN (
    SELECT name FROM (
        SELECT name, SUM(bytes) OVER newest AS total, ROW_NUMBER() OVER newest AS place
        FROM {table} WINDOW newest AS (ORDER BY used DESC, rowid DESC)
    ) WHERE total > ? OR place > ?
)
"""


class SqliteDocumentStore:
    """Keeps the most recently used documents of a table, bounded in number and size.

    Args:
        store: The open plan store, whose file also holds the documents.
        table: The table that holds them.
        max_documents: Largest number of documents.
        max_bytes: Largest total size [bytes].
    """

    def __init__(
        self, store: SqlitePlanStore, table: Table, max_documents: int, max_bytes: int
    ) -> None:
        self._store = store
        self._table = table
        self._max_documents = max_documents
        self._max_bytes = max_bytes

    async def put(self, name: str, document: StoredDocument) -> bool:
        """Store a document and evict the least recently used ones."""
        size = len(document.document) + len(document.info)
        async with self._store.writing() as connection:
            delete = f"DELETE FROM {self._table} WHERE name = ?"
            async with connection.execute(delete, (name,)) as cursor:
                new = cursor.rowcount == 0
            await connection.execute(
                f"INSERT INTO {self._table} (name, bytes, used, document, info) "
                "VALUES (?, ?, ?, ?, ?)",
                (name, size, time.time(), *document),
            )
            await connection.execute(
                _SURPLUS.format(table=self._table), (self._max_bytes, self._max_documents)
            )
        return new

    async def get(self, name: str) -> StoredDocument | None:
        """Return a document, or None if it is not stored."""
        row = await self._store.row(
            f"SELECT document, info FROM {self._table} WHERE name = ?", (name,)
        )
        if row is None:
            return None
        with contextlib.suppress(StoreFault):  # reading still works
            await self._store.change(
                f"UPDATE {self._table} SET used = ? WHERE name = ?", (time.time(), name)
            )
        return StoredDocument(bytes(row[0]), bytes(row[1]))

    async def delete(self, name: str) -> bool:
        """Delete a document; return whether it was stored."""
        async with (
            self._store.writing() as connection,
            connection.execute(f"DELETE FROM {self._table} WHERE name = ?", (name,)) as cursor,
        ):
            return cursor.rowcount > 0

    async def names(self) -> list[str]:
        """Return the names of all stored documents, sorted."""
        row = await self._store.row(
            f"SELECT json_group_array(name) FROM (SELECT name FROM {self._table} ORDER BY name)", ()
        )
        names: list[str] = json.loads(row[0])
        return names
