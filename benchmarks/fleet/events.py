"""How late the events of a job are at another replica than its own."""

from __future__ import annotations

import asyncio
import json
import statistics
import time
from typing import Any

import httpx
import psycopg

from benchmarks.fleet.replica import Replica
from benchmarks.fleet.requests import request
from ikplan_api.store.plan_store import Job
from ikplan_api.store.postgres.store import PostgresBounds, PostgresStore

__all__ = ["event_latency", "notification_latency"]


def event_latency(
    database: str, replicas: list[Replica], *, jobs: int, waypoints: int
) -> dict[str, Any]:
    """Submit at one replica, watch at the other: time from the commit to the client [s]."""
    heard: dict[str, float] = {}
    count = 0
    for number in range(jobs):
        here, there = replicas[number % 2], replicas[1 - number % 2]
        document = request(100_000 + number, waypoints)
        answer = httpx.post(
            f"{here.address}/v1/plans",
            json=document,
            headers={"prefer": "respond-async"},
            timeout=60.0,
        )
        plan_id = str(answer.json()["id"])
        url = f"{there.address}/v1/plans/{plan_id}/events"
        with httpx.stream("GET", url, timeout=120.0) as stream:
            for line in stream.iter_lines():
                if line.startswith("data:"):
                    count += 1
                    if json.loads(line.removeprefix("data:")).get("state") == "finished":
                        heard[plan_id] = time.time()
    with psycopg.connect(database) as connection:
        rows = connection.execute(
            "SELECT subject, extract(epoch FROM time)::float8, replica FROM audit "
            "WHERE action = 'finished'"
        ).fetchall()
    late = sorted(heard[subject] - at for subject, at, _ in rows if subject in heard)
    return {
        "jobs": jobs,
        "events": count,
        "finished heard": len(heard),
        "latency p50 [ms]": round(1e3 * statistics.median(late), 1),
        "latency p99 [ms]": round(1e3 * late[min(len(late) - 1, int(0.99 * len(late)))], 1),
        "largest [ms]": round(1e3 * late[-1], 1),
    }


def notification_latency(database: str, jobs: int) -> dict[str, Any]:
    """Without workers and HTTP: from before the write at one replica to the other one hearing."""
    return asyncio.run(_notified(database, jobs))


async def _notified(database: str, jobs: int) -> dict[str, Any]:
    bounds = PostgresBounds(10 * jobs, 10**12, 1e6, object_bytes=2**20)
    here, there = (PostgresStore(database, bounds, lease_s=60.0) for _ in range(2))
    await here.open()
    await there.open()
    late = []
    try:
        for number in range(jobs):
            job = Job(f"n{number}", "plan", b"{}", None, 10.0)
            with there.changes.of(("", job.plan_id)) as changes:
                claim = await here.queue.begin(job)
                assert claim is not None
                for write, state in (
                    (lambda: here.queue.progress(claim, "ik", 1, 2), "running"),  # noqa: B023
                    (lambda: here.queue.finish(claim, b"{}"), "finished"),  # noqa: B023
                ):
                    began = time.perf_counter()
                    writing = asyncio.ensure_future(write())
                    while (change := await changes.get()) is None or change["state"] != state:
                        pass
                    late.append(time.perf_counter() - began)
                    await writing
    finally:
        await here.close()
        await there.close()
    late.sort()
    return {
        "changes": len(late),
        "latency p50 [ms]": round(1e3 * statistics.median(late), 1),
        "latency p99 [ms]": round(1e3 * late[int(0.99 * len(late))], 1),
        "largest [ms]": round(1e3 * late[-1], 1),
    }
