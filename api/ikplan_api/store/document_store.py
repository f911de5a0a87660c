"""Interface of a store for uploaded robots or scenes, and one in memory."""

from __future__ import annotations

from collections import OrderedDict
from typing import NamedTuple, Protocol

from ikplan_api.store.owners import EVERYONE, scoped, unscoped

__all__ = ["DocumentStore", "MemoryDocumentStore", "StoredDocument"]


class StoredDocument(NamedTuple):
    """An uploaded robot or scene.

    Attributes:
        document: The upload in canonical form, as the workers receive it.
        info: The response of ``GET /v1/robots/{name}`` or ``GET /v1/scenes/{id}``.
    """

    document: bytes
    info: bytes


class DocumentStore(Protocol):
    """Uploaded robots or scenes by id."""

    async def put(self, name: str, document: StoredDocument, owner: str = EVERYONE) -> bool:
        """Store a document; return whether it is new.

        Raises:
            StoreFault: The write fails.
        """

    async def get(self, name: str, owner: str = EVERYONE) -> StoredDocument | None:
        """Return a document, or None if it is not stored."""

    async def delete(self, name: str, owner: str = EVERYONE) -> bool:
        """Delete a document; return whether it was stored.

        Raises:
            StoreFault: The write fails.
        """

    async def names(self, owner: str = EVERYONE) -> list[str]:
        """Return the names of all stored documents, sorted."""


class MemoryDocumentStore:
    """Keeps the most recently used documents of all owners in memory, bounded in number and size.

    Args:
        max_documents: Largest number of documents.
        max_bytes: Largest total size [bytes].
    """

    def __init__(self, max_documents: int, max_bytes: int) -> None:
        self._max_documents = max_documents
        self._max_bytes = max_bytes
        self._documents: OrderedDict[str, StoredDocument] = OrderedDict()
        self._bytes = 0

    async def put(self, name: str, document: StoredDocument, owner: str = EVERYONE) -> bool:
        """Store a document and evict the least recently used ones."""
        name, new = scoped(owner, name), not await self.delete(name, owner)
        self._documents[name] = document
        self._bytes += _size(document)
        while len(self._documents) > self._max_documents or self._bytes > self._max_bytes:
            _, oldest = self._documents.popitem(last=False)
            self._bytes -= _size(oldest)
        return new

    async def get(self, name: str, owner: str = EVERYONE) -> StoredDocument | None:
        """Return a document, or None if it is not stored."""
        name = scoped(owner, name)
        if name in self._documents:
            self._documents.move_to_end(name)
        return self._documents.get(name)

    async def delete(self, name: str, owner: str = EVERYONE) -> bool:
        """Delete a document; return whether it was stored."""
        document = self._documents.pop(scoped(owner, name), None)
        if document is None:
            return False
        self._bytes -= _size(document)
        return True

    async def names(self, owner: str = EVERYONE) -> list[str]:
        """Return the names of all stored documents, sorted."""
        prefix = scoped(owner, "")
        return sorted(
            unscoped(name)
            for name in self._documents
            if (name.startswith(prefix) if prefix else ":" not in name)
        )


def _size(document: StoredDocument) -> int:
    return len(document.document) + len(document.info)
