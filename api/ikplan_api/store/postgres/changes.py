"""What other replicas tell: new jobs, their progress and their ends."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import psycopg

from ikplan_api.cancelling import cancelled

__all__ = ["CHANNEL", "Changes"]

_log = logging.getLogger("ikplan.service")

CHANNEL = "ikplan"
_AGAIN_S = 0.5
Key = tuple[str, str]
Change = dict[str, Any]


class Changes:
    """Listens to the notifications of the database, on a connection of its own.

    A notification can be lost, as while the database restarts: who waits for one also looks at
    the row now and then.

    Args:
        url: Address of the database.
        heard: Is told the key and the content of each change; None: some may have been missed.
    """

    def __init__(self, url: str, heard: Callable[[Key | None, Change], None]) -> None:
        self._url = url
        self._heard = heard
        self._queues: dict[Key, set[asyncio.Queue[Change | None]]] = {}
        self._listening: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to listen."""
        self._listening = asyncio.create_task(self._listen())

    async def stop(self) -> None:
        """End to listen."""
        if self._listening is not None:
            await cancelled([self._listening])
            self._listening = None

    @contextmanager
    def of(self, key: Key) -> Iterator[asyncio.Queue[Change | None]]:
        """Receive the changes of one job; None: some may have been missed."""
        queue: asyncio.Queue[Change | None] = asyncio.Queue()
        self._queues.setdefault(key, set()).add(queue)
        try:
            yield queue
        finally:
            self._queues[key].discard(queue)
            if not self._queues[key]:
                del self._queues[key]

    async def _listen(self) -> None:
        while True:
            try:
                async with await psycopg.AsyncConnection.connect(
                    self._url, autocommit=True, application_name="ikplan listener"
                ) as connection:
                    await connection.execute(f"LISTEN {CHANNEL}".encode())
                    self._all(None)
                    async for notification in connection.notifies():
                        self._pass_on(notification.payload)
            except psycopg.Error as error:
                _log.warning("the database does not tell of changes now: %s", error)
                await asyncio.sleep(_AGAIN_S)

    def _pass_on(self, payload: str) -> None:
        with contextlib.suppress(ValueError, KeyError, TypeError):  # not one of ours
            change = json.loads(payload)
            key = str(change["owner"]), str(change["id"])
            self._heard(key, change)
            for queue in self._queues.get(key, ()):
                queue.put_nowait(change)

    def _all(self, change: None) -> None:
        self._heard(None, {})
        for queues in self._queues.values():
            for queue in queues:
                queue.put_nowait(change)
