"""Two replicas in this process, each an app with a worker, on one database."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any

import httpx

from ikplan.client.api_keys import key_hash
from ikplan_api.app import create_app
from ikplan_api.jobs.fleet_jobs import FleetJobs
from ikplan_api.settings import Settings

from ..conftest import ADDRESS
from .in_process import InProcess

KEYS = {name: f"ikp_{name}" for name in ("anna", "berta", "reader", "auditor", "monitor")}
ENTRIES = [
    f"anna:{key_hash(KEYS['anna'])}",
    f"berta:{key_hash(KEYS['berta'])};jobs=2",
    *(f"{role}:{key_hash(KEYS[role])};role={role}" for role in ("reader", "auditor", "monitor")),
]


class Replica:
    """A replica.

    Attributes:
        http: Asks it.
        planner: Its worker.
        jobs: Its jobs.
    """

    def __init__(self, http: httpx.AsyncClient, planner: InProcess, jobs: FleetJobs) -> None:
        self.http = http
        self.planner = planner
        self.jobs = jobs


def key(name: str) -> dict[str, str]:
    """The header of a key."""
    return {"authorization": f"Bearer {KEYS[name]}"}


@contextlib.asynccontextmanager
async def replica(database: str, **settings: Any) -> AsyncIterator[Replica]:
    planner = InProcess()
    given = {"lease_s": 1.0, "rate_limit": "", "robot_timeout_s": 120.0, "stop_s": 5.0, **settings}
    where = {"store_url": database} if database.startswith("postgres") else {"store_path": database}
    options: dict[str, Any] = {**where, **given}
    app = create_app(Settings(**options), planner=planner)
    transport = httpx.ASGITransport(app, raise_app_exceptions=False)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url=ADDRESS, timeout=60.0) as http,
    ):
        yield Replica(http, planner, app.state.plan_jobs)


def served(
    database: str,
    scenario: Callable[[Replica, Replica], Awaitable[Any]],
    within_s: float = 300.0,
    **settings: Any,
) -> Any:
    """Run a scenario with two replicas; with one, given twice, where the database is a file."""

    async def run() -> Any:
        async with contextlib.AsyncExitStack() as stack, asyncio.timeout(within_s):
            here = await stack.enter_async_context(replica(database, **settings))
            there = here
            if database.startswith("postgres"):
                there = await stack.enter_async_context(replica(database, **settings))
            return await scenario(here, there)

    return asyncio.run(run())


async def until(true: Callable[[], Awaitable[object]]) -> None:
    while not await true():
        await asyncio.sleep(0.02)
