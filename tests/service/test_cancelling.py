"""Loops of the service end when it closes, whatever drops their cancellation."""

from __future__ import annotations

import asyncio

import pytest

from ikplan_api import cancelling
from ikplan_api.cancelling import cancelled


async def loop(dropped: list[int]) -> None:
    """Run until cancelled, and ignore one cancellation for each entry of the list."""
    while True:
        try:
            await asyncio.sleep(30.0)
        except asyncio.CancelledError:
            if not dropped:
                raise
            dropped.pop()


@pytest.mark.parametrize("drops", [0, 1, 3])
def test_a_task_that_drops_cancellations_ends_all_the_same(
    monkeypatch: pytest.MonkeyPatch, drops: int
) -> None:
    monkeypatch.setattr(cancelling, "_AGAIN_S", 0.01)

    async def run() -> list[asyncio.Task[None]]:
        tasks = [asyncio.create_task(loop([1] * drops)), asyncio.create_task(loop([]))]
        await asyncio.sleep(0.0)
        async with asyncio.timeout(20.0):
            await cancelled(tasks)
        return tasks

    assert all(task.cancelled() for task in asyncio.run(run()))


def test_what_has_ended_and_nothing_at_all_are_not_waited_for() -> None:
    async def run() -> None:
        ended = asyncio.create_task(asyncio.sleep(0.0))
        await ended
        async with asyncio.timeout(20.0):
            await cancelled([ended])
            await cancelled([])

    asyncio.run(run())
