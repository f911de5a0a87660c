"""A closed loop of clients, and more clients than there is room for."""

from __future__ import annotations

import asyncio
import collections
import itertools
import json
import multiprocessing
import statistics
import time
from collections.abc import Iterator

import httpx

import ikplan
from benchmarks.service.requests import helices
from benchmarks.service.server import Server, serving

__all__ = ["measure_load", "measure_overload"]

_HEADERS = {"content-type": "application/json", "accept-encoding": "identity"}


def _rate_here(seconds: float) -> float:
    """Plans per second of one process that does nothing else [1/s]."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_plan_for, (seconds,))


def _plan_for(seconds: float) -> float:
    requests = helices(10**6)
    for body in itertools.islice(requests, 3):
        ikplan.plan(json.loads(body))
    begin, count = time.perf_counter(), 0
    while time.perf_counter() - begin < seconds:
        ikplan.plan(json.loads(next(requests)))
        count += 1
    return count / (time.perf_counter() - begin)


async def _client(
    http: httpx.AsyncClient, bodies: Iterator[bytes], until: float, seen: list[tuple[int, float]]
) -> None:
    while time.perf_counter() < until:
        begin = time.perf_counter()
        answer = await http.post("/v1/plans", content=next(bodies), headers=_HEADERS)
        seen.append((answer.status_code, time.perf_counter() - begin))


async def _closed_loop(
    address: str, clients: int, seconds: float, bodies: Iterator[bytes]
) -> tuple[list[tuple[int, float]], list[float], float]:
    """Statuses and times of all answers, times of /livez, and the time it took [s]."""
    seen: list[tuple[int, float]] = []
    alive: list[float] = []
    limits = httpx.Limits(max_connections=None)
    async with httpx.AsyncClient(base_url=address, timeout=120.0, limits=limits) as http:
        begin = time.perf_counter()
        loops = [
            asyncio.create_task(_client(http, bodies, begin + seconds, seen))
            for _ in range(clients)
        ]
        while not all(loop.done() for loop in loops):
            asked = time.perf_counter()
            await http.get("/livez")
            alive.append(time.perf_counter() - asked)
            await asyncio.sleep(0.2)
        await asyncio.gather(*loops)
        return seen, alive, time.perf_counter() - begin


def measure_load(seconds: float = 60.0) -> list[str]:
    """Let 8 clients ask 2 workers for new helices, each as soon as it has its answer."""
    before = _rate_here(min(10.0, seconds))
    with serving(workers="2") as server:
        asyncio.run(_closed_loop(server.address, 8, 3.0, helices(2 * 10**6)))
        seen, alive, took = asyncio.run(_closed_loop(server.address, 8, seconds, helices()))
        memory = server.memory_bytes()
    after = _rate_here(min(10.0, seconds))
    single = statistics.mean([before, after])
    times = sorted(t for _, t in seen)
    failed = sum(status != 200 for status, _ in seen)
    rate = len(seen) / took
    return [
        f"{len(seen)} answers in {took:.0f} s, {failed} failed; {rate:.1f} per second",
        f"one process alone: {before:.1f} before, {after:.1f} after; "
        f"{100 * rate / (2 * single):.0f} % of twice that",
        f"latency: median {1e3 * statistics.median(times):.0f} ms, "
        f"p99 {1e3 * times[int(0.99 * len(times))]:.0f} ms",
        f"/livez, asked by the busy load generator: median {1e3 * statistics.median(alive):.1f} ms,"
        f" p99 {1e3 * sorted(alive)[int(0.99 * len(alive))]:.1f} ms",
        f"memory of all processes: {memory / 2**20:.0f} MiB",
    ]


def _solo(server: Server, first: int) -> float:
    """Median time of a few requests one after the other [s]."""
    with httpx.Client(base_url=server.address, timeout=120.0) as http:
        times = []
        for body in itertools.islice(helices(first), 5):
            begin = time.perf_counter()
            assert http.post("/v1/plans", content=body, headers=_HEADERS).status_code == 200
            times.append(time.perf_counter() - begin)
        return statistics.median(times)


def measure_overload(seconds: float = 20.0) -> list[str]:
    """Let 200 clients ask at once, and see what is left of the service afterwards."""
    with serving(workers="2", max_queued="16") as server:
        calm, rest = _solo(server, 3 * 10**6), server.memory_bytes()
        seen, alive, took = asyncio.run(_closed_loop(server.address, 200, seconds, helices()))
        full = server.memory_bytes()
        begin = time.perf_counter()
        after = _solo(server, 4 * 10**6)
        back = time.perf_counter() - begin
    counts = collections.Counter(status for status, _ in seen)
    return [
        f"200 clients for {took:.0f} s: "
        + ", ".join(f"{count} x {status}" for status, count in sorted(counts.items())),
        f"/livez: p99 {1e3 * sorted(alive)[int(0.99 * len(alive))]:.0f} ms of {len(alive)}, "
        "asked by the generator that the 200 clients live in",
        f"memory of all processes: {rest / 2**20:.0f} MiB before, {full / 2**20:.0f} MiB after",
        f"alone: {1e3 * calm:.0f} ms before, {1e3 * after:.0f} ms after; five plans were answered "
        f"{back:.1f} s after the last client left",
    ]
