"""A replica in a process of its own that is there at once: its planner sleeps, all else is real."""

from __future__ import annotations

import asyncio
from typing import Any

from ikplan_api.jobs.fleet_jobs import FleetJobs
from ikplan_api.store.postgres.store import PostgresBounds, PostgresStore
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.tasks import TaskResult

BOUNDS = PostgresBounds(10_000, 10**9, max_age_s=3600.0, object_bytes=2**20)


class Sleeper:
    """One worker that takes some time for everything."""

    ready = True

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._pending = 0
        self._turn = asyncio.Semaphore(1)

    @property
    def load(self) -> Load:
        return Load(1, min(1, self._pending), max(0, self._pending - 1))

    def check_capacity(self) -> None:
        return None

    async def run(self, kind: str, document: bytes, **how: Any) -> TaskResult:
        assert kind == "plan"
        self._pending += 1
        try:
            async with self._turn:
                how["progress"]("ik", 0, 1)
                await asyncio.sleep(self._seconds)
                return TaskResult(b'{"made of": %s}' % document)
        finally:
            self._pending -= 1

    async def warm_up(self) -> None:
        return None

    async def close(self) -> None:
        return None


def run_replica(database: str, lease_s: float, seconds: float) -> None:
    """Run jobs until the process is killed."""
    asyncio.run(_run(database, lease_s, seconds))


async def _run(database: str, lease_s: float, seconds: float) -> None:
    store = PostgresStore(database, BOUNDS, lease_s=lease_s)
    await store.open()
    jobs = FleetJobs(
        Sleeper(seconds), store, 60.0, lease_s=lease_s, max_jobs=10_000, quota=lambda _: None
    )
    await jobs.resume()
    await asyncio.Event().wait()
