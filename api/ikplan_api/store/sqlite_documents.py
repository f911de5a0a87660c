"""Uploaded robots and scenes in the SQLite file of the plans: they survive a restart."""

from __future__ import annotations

import contextlib
import time
from typing import Literal

from ikplan_api.store.document_store import StoredDocument
from ikplan_api.store.owners import EVERYONE, scoped, unscoped
from ikplan_api.store.plan_store import StoreFault
from ikplan_api.store.sqlite_file import SqliteFile

__all__ = ["SqliteDocumentStore", "Table"]

Table = Literal["robots", "scenes"]

_SURPLUS = """
DELETE FROM {table} WHERE name IN (
    SELECT name FROM (
        SELECT name, SUM(bytes) OVER newest AS total, ROW_NUMBER() OVER newest AS place
        FROM {table} WHERE owner = ? WINDOW newest AS (ORDER BY used DESC, rowid DESC)
    ) WHERE total > ? OR place > ?
)
"""


class SqliteDocumentStore:
    """Keeps the most recently used documents of a table, bounded in number and size for each owner.

    Args:
        store: The open plan store, whose file also holds the documents.
        table: The table that holds them.
        max_documents: Largest number of documents.
        max_bytes: Largest total size [bytes].
    """

    def __init__(self, store: SqliteFile, table: Table, max_documents: int, max_bytes: int) -> None:
        self._store = store
        self._table = table
        self._max_documents = max_documents
        self._max_bytes = max_bytes

    async def put(self, name: str, document: StoredDocument, owner: str = EVERYONE) -> bool:
        """Store a document and evict the least recently used ones."""
        size, name = len(document.document) + len(document.info), scoped(owner, name)
        async with self._store.writing() as connection:
            delete = f"DELETE FROM {self._table} WHERE name = ?"
            async with connection.execute(delete, (name,)) as cursor:
                new = cursor.rowcount == 0
            await connection.execute(
                f"INSERT INTO {self._table} (name, bytes, used, document, info, owner) "
                "VALUES (?, ?, ?, ?, ?, ?)",
                (name, size, time.time(), *document, owner),
            )
            await connection.execute(
                _SURPLUS.format(table=self._table), (owner, self._max_bytes, self._max_documents)
            )
        return new

    async def get(self, name: str, owner: str = EVERYONE) -> StoredDocument | None:
        """Return a document, or None if it is not stored."""
        name = scoped(owner, name)
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

    async def delete(self, name: str, owner: str = EVERYONE) -> bool:
        """Delete a document; return whether it was stored."""
        name = scoped(owner, name)
        async with (
            self._store.writing() as connection,
            connection.execute(f"DELETE FROM {self._table} WHERE name = ?", (name,)) as cursor,
        ):
            return cursor.rowcount > 0

    async def names(self, owner: str = EVERYONE) -> list[str]:
        """Return the names of all stored documents, sorted."""
        query = f"SELECT name FROM {self._table} WHERE owner = ? ORDER BY name"
        return [unscoped(name) for (name,) in await self._store.rows(query, (owner,))]
