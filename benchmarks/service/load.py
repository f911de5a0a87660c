"""A closed loop of clients, and more clients than there is room for."""

from __future__ import annotations

import asyncio
import collections
import itertools
import json
import multiprocessing
import re
import statistics
import time
from collections.abc import Iterator
from urllib.parse import urlsplit

import httpx

import ikplan
from benchmarks.service.probe import over_bounds, probing, told
from benchmarks.service.requests import helices
from benchmarks.service.server import Server, serving

__all__ = ["measure_load", "measure_overload"]

_MAX_WAIT_S = 10.0
_SECONDS = "ikplan_http_request_seconds"
_HEAD = (
    "POST /v1/plans HTTP/1.1\r\nhost: {}\r\ncontent-type: application/json\r\n"
    "accept-encoding: identity\r\ncontent-length: {}\r\n\r\n"
)
_HEADERS = {"content-type": "application/json", "accept-encoding": "identity"}


def _rate_here(seconds: float, processes: int = 1) -> tuple[float, float]:
    """Plans of processes that do nothing else: per second in all, processor time of each [s]."""
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        rates, costs = zip(*pool.map(_plan_for, [seconds] * processes, 1), strict=True)
    return sum(rates), statistics.mean(costs)


def _plan_for(seconds: float) -> tuple[float, float]:
    requests = helices(10**6)
    for body in itertools.islice(requests, 3):
        ikplan.plan(json.loads(body))
    begin, own, count = time.perf_counter(), time.process_time(), 0
    while time.perf_counter() - begin < seconds:
        ikplan.plan(json.loads(next(requests)))
        count += 1
    rate = count / (time.perf_counter() - begin)
    return rate, (time.process_time() - own) / count


async def _client(
    address: str, bodies: Iterator[bytes], until: float, seen: list[tuple[int, float]]
) -> None:
    """Ask on one connection, by hand: the clients have the same processors as the service."""
    place = urlsplit(address)
    connection: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None
    while time.perf_counter() < until:
        body = next(bodies)
        begin = time.perf_counter()
        if connection is None:
            connection = await asyncio.open_connection(place.hostname, place.port, limit=2**20)
        reader, writer = connection
        writer.write(_HEAD.format(place.netloc, len(body)).encode() + body)
        head = (await reader.readuntil(b"\r\n\r\n")).lower()
        (length,) = re.findall(rb"content-length: (\d+)", head)
        await reader.readexactly(int(length))
        seen.append((int(head.split(None, 2)[1]), time.perf_counter() - begin))
        if b"connection: close" in head:
            writer.close()
            connection = None
    if connection is not None:
        connection[1].close()


async def _closed_loop(
    address: str, clients: int, seconds: float, bodies: Iterator[bytes]
) -> tuple[list[tuple[int, float]], float]:
    """Statuses and times of all answers, and the time it took [s]."""
    seen: list[tuple[int, float]] = []
    begin = time.perf_counter()
    loops = [_client(address, bodies, begin + seconds, seen) for _ in range(clients)]
    await asyncio.gather(*loops)
    return seen, time.perf_counter() - begin


def measure_load(seconds: float = 60.0) -> list[str]:
    """Let 8 clients ask 2 workers for new helices, each as soon as it has its answer."""
    before, cost_before = _rate_here(min(10.0, seconds))
    with serving(workers="2") as server:
        asyncio.run(_closed_loop(server.address, 8, 3.0, helices(2 * 10**6)))
        own_s, spent_s = time.process_time(), server.processor_s()
        with probing(server.address) as alive:
            seen, took = asyncio.run(_closed_loop(server.address, 8, seconds, helices()))
        own_s, spent_s = time.process_time() - own_s, server.processor_s() - spent_s
        memory = server.memory_bytes()
    after, cost_after = _rate_here(min(10.0, seconds))
    both, _ = _rate_here(min(10.0, seconds), 2)
    cost, each = 0.5 * (cost_before + cost_after), 1.0 / len(seen)
    single = statistics.mean([before, after])
    times = sorted(t for _, t in seen)
    failed = sum(status != 200 for status, _ in seen)
    rate = len(seen) / took
    return [
        f"{len(seen)} answers in {took:.0f} s, {failed} failed; {rate:.1f} per second",
        f"one process alone: {before:.1f} before, {after:.1f} after; "
        f"{100 * rate / (2 * single):.0f} % of twice that",
        f"two processes at once, without a service: {both:.1f}, which is "
        f"{100 * both / (2 * single):.0f} % of twice one; the service reaches "
        f"{100 * rate / both:.0f} % of that",
        f"latency: median {1e3 * statistics.median(times):.0f} ms, "
        f"p99 {1e3 * times[int(0.99 * len(times))]:.0f} ms",
        f"processor time of an answer: {1e3 * spent_s * each:.0f} ms of the service and "
        f"{1e3 * own_s * each:.0f} ms of the clients; of a plan alone: {1e3 * cost:.0f} ms, "
        f"{100 * cost / ((spent_s + own_s) * each):.0f} % of that",
        told(alive),
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
    with serving(workers="2", max_queued="16", max_wait_s=str(_MAX_WAIT_S)) as server:
        calm, rest = _solo(server, 3 * 10**6), server.memory_bytes()
        with probing(server.address) as alive:
            seen, took = asyncio.run(_closed_loop(server.address, 200, seconds, helices()))
        full, metrics = server.memory_bytes(), server.metrics()
        begin = time.perf_counter()
        after = _solo(server, 4 * 10**6)
        back = time.perf_counter() - begin
    counts = collections.Counter(status for status, _ in seen)
    longest = max(t for status, t in seen if status == 200)
    refused = sorted(t for status, t in seen if status != 200)
    return [
        f"200 clients for {took:.0f} s: "
        + ", ".join(f"{count} x {status}" for status, count in sorted(counts.items())),
        f"longest wait for a plan: {longest:.2f} s, of {_MAX_WAIT_S:g} s for a worker and its own "
        f"time; for a refusal: median {1e3 * statistics.median(refused):.0f} ms, longest "
        f"{refused[-1]:.2f} s",
        f"in the service, refusals: {over_bounds(metrics, _SECONDS, status='503')}",
        f"in the service, plans: {over_bounds(metrics, _SECONDS, status='200', method='POST')}",
        told(alive),
        f"memory of all processes: {rest / 2**20:.0f} MiB before, {full / 2**20:.0f} MiB after",
        f"alone: {1e3 * calm:.0f} ms before, {1e3 * after:.0f} ms after; five plans were answered "
        f"{back:.1f} s after the last client left",
    ]
