"""How late the events of a job are at another replica than its own."""

from __future__ import annotations

import json
import statistics
import time
from typing import Any

import httpx
import psycopg

from benchmarks.fleet.replica import Replica
from benchmarks.fleet.requests import request

__all__ = ["event_latency"]


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
