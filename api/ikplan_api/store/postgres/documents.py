"""Uploaded robots and scenes in PostgreSQL."""

from __future__ import annotations

from typing import Literal

from ikplan_api.store.document_store import StoredDocument
from ikplan_api.store.owners import EVERYONE
from ikplan_api.store.postgres.database import Database

__all__ = ["PostgresDocumentStore"]

_PUT = """
INSERT INTO uploads (kind, owner, name, bytes, document, info)
VALUES (%(kind)s, %(owner)s, %(name)s, %(bytes)s, %(document)s, %(info)s)
ON CONFLICT (kind, owner, name) DO UPDATE SET
    bytes = excluded.bytes, document = excluded.document, info = excluded.info,
    used = clock_timestamp()
RETURNING xmax = 0
"""
_SURPLUS = """
DELETE FROM uploads WHERE (kind, owner, name) IN (
    SELECT kind, owner, name FROM (
        SELECT kind, owner, name, SUM(bytes) OVER newest AS total,
            ROW_NUMBER() OVER newest AS place
        FROM uploads WHERE kind = %(kind)s AND owner = %(owner)s
        WINDOW newest AS (ORDER BY used DESC, name)
    ) AS listed WHERE total > %(max_bytes)s OR place > %(max_documents)s
)
"""
_GET = """
WITH used AS (
    UPDATE uploads SET used = clock_timestamp()
    WHERE kind = %s AND owner = %s AND name = %s AND used < now() - interval '1 minute'
)
SELECT document, info FROM uploads WHERE kind = %s AND owner = %s AND name = %s
"""


class PostgresDocumentStore:
    """Keeps the most recently used documents, bounded in number and size for each owner.

    Args:
        database: The database.
        kind: What the documents are.
        max_documents: Largest number of documents of an owner.
        max_bytes: Largest total size of the documents of an owner [bytes].
    """

    def __init__(
        self,
        database: Database,
        kind: Literal["robots", "scenes"],
        max_documents: int,
        max_bytes: int,
    ) -> None:
        self._database = database
        self._kind = kind
        self._max_documents = max_documents
        self._max_bytes = max_bytes

    async def put(self, name: str, document: StoredDocument, owner: str = EVERYONE) -> bool:
        """Store a document and evict the least recently used ones; return whether it is new."""
        values = {
            "kind": self._kind,
            "owner": owner,
            "name": name,
            "bytes": len(document.document) + len(document.info),
            "document": document.document,
            "info": document.info,
            "max_bytes": self._max_bytes,
            "max_documents": self._max_documents,
        }
        async with self._database.connection() as connection, connection.transaction():
            row = await (await connection.execute(_PUT, values)).fetchone()
            await connection.execute(_SURPLUS, values)
        assert row is not None
        return bool(row[0])

    async def get(self, name: str, owner: str = EVERYONE) -> StoredDocument | None:
        """Return a document, or None if it is not stored."""
        row = await self._database.row(_GET, (self._kind, owner, name) * 2)
        return None if row is None else StoredDocument(bytes(row[0]), bytes(row[1]))

    async def delete(self, name: str, owner: str = EVERYONE) -> bool:
        """Delete a document; return whether it was stored."""
        query = "DELETE FROM uploads WHERE kind = %s AND owner = %s AND name = %s RETURNING 1"
        return bool(await self._database.rows(query, (self._kind, owner, name)))

    async def names(self, owner: str = EVERYONE) -> list[str]:
        """Return the names of all stored documents, sorted."""
        query = 'SELECT name FROM uploads WHERE kind = %s AND owner = %s ORDER BY name COLLATE "C"'
        rows = await self._database.rows(query, (self._kind, owner))
        return [str(name) for (name,) in rows]
