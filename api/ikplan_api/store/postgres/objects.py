"""Long documents in an object store."""

from __future__ import annotations

import asyncio
import contextlib
import uuid
from typing import Any

import fsspec

from ikplan.errors import InvalidRequest

__all__ = ["ObjectStore"]

_SETTING = "IKPLAN_OBJECT_STORE_URL"


class ObjectStore:
    """Documents by name below an address that fsspec knows, such as ``s3://bucket/plans``.

    Each document is written once under a name of its own and never changed.

    Args:
        url: The address.

    Raises:
        InvalidRequest: Its scheme is not known, or its package is not installed.
    """

    def __init__(self, url: str) -> None:
        try:
            self._files, root = fsspec.url_to_fs(url)
        except (ImportError, ValueError, OSError) as error:
            raise InvalidRequest(
                f"{_SETTING}: {error}", field=_SETTING, allowed="an address that fsspec knows"
            ) from error
        self._root = str(root).rstrip("/")

    async def put(self, document: bytes) -> str:
        """Write a document; return its name.

        Raises:
            OSError: The write fails.
        """
        name = uuid.uuid4().hex
        await asyncio.to_thread(self._put, self._path(name), document)
        return name

    def _put(self, path: str, document: bytes) -> None:
        if "file" in _protocols(self._files):
            self._files.makedirs(path.rpartition("/")[0], exist_ok=True)
        self._files.pipe_file(path, document)

    async def get(self, name: str) -> bytes | None:
        """Return a document, or None if it is gone.

        Raises:
            OSError: The read fails.
        """
        try:
            return bytes(await asyncio.to_thread(self._files.cat_file, self._path(name)))
        except FileNotFoundError:
            return None

    async def delete(self, name: str) -> None:
        """Delete a document, if it is there.

        Raises:
            OSError: The deletion fails.
        """
        with contextlib.suppress(FileNotFoundError):
            await asyncio.to_thread(self._files.rm_file, self._path(name))

    def _path(self, name: str) -> str:
        # 256 folders: a folder of a file system with millions of files is slow.
        return f"{self._root}/{name[:2]}/{name}.json.zst"


def _protocols(files: Any) -> tuple[str, ...]:
    named = files.protocol
    return (named,) if isinstance(named, str) else tuple(named)
