"""Tasks that go on until they are cancelled, and end then."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import Any

__all__ = ["cancelled"]

_AGAIN_S = 1.0


async def cancelled(tasks: Iterable[asyncio.Task[Any]]) -> None:
    """Cancel tasks and wait until all of them have ended.

    A task that goes on is asked again: ``asyncio.wait_for`` of Python 3.11, by which connections to
    the database are waited for, drops a cancellation that comes as what it waits for is done.

    Args:
        tasks: The tasks, none of which takes long to end.
    """
    left = set(tasks)
    while left:
        for task in left:
            task.cancel()
        _, left = await asyncio.wait(left, timeout=_AGAIN_S)
