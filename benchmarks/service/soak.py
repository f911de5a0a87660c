"""Requests of every kind among kills, slow clients and cancellations, and what is left of it."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import os
import re
import signal
import socket
import time
from collections import Counter, deque
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path

import httpx
import numpy as np

from benchmarks.service.probe import over_bounds, probing, told
from benchmarks.service.requests import helices
from benchmarks.service.server import Server, serving

__all__ = ["soak"]

_CLIENTS = 24
_SLOW_CLIENTS = 100
_KILL_EVERY_S = 3.0
_JOBS_S = 120.0
"""Longest time that an accepted job may take after those before it [s]."""
_EXPECTED = {200, 202, 204, 304, 404, 406, 408, 415, 422, 503}
_NDJSON = {"content-type": "application/x-ndjson"}

Act = Callable[[httpx.AsyncClient], Awaitable[httpx.Response]]


def soak(requests: int = 20_000, seconds: float = 1200.0) -> Iterator[str]:
    """Ask so many requests, or for so long [s], and tell what is left and what was not answered."""
    with serving(workers="2", header_s="5", body_s="10") as server:
        asyncio.run(_Soak(server, 40, 30.0).run())  # every path once: caches are full after it
        before = _state(server)
        study, load = _Soak(server, requests, seconds), os.getloadavg()[1]
        with probing(server.address) as alive:
            asyncio.run(study.run())
        time.sleep(5.0)
        after = _state(server)
        shared = server.shared_files()
        lag, closed = _loop_lag(server), _closed(server)
    yield (
        f"{study.asked} requests in {study.took_s:.0f} s, {study.kills} workers killed; "
        f"load of the machine {load:.0f} before, {os.getloadavg()[1]:.0f} after"
    )
    yield "answers: " + ", ".join(f"{k}: {n}" for k, n in sorted(study.answers.items()))
    yield f"without an answer: {study.unanswered or 'none'}"
    yield f"closed by the service: {closed}"
    yield f"accepted jobs: {study.jobs}"
    yield told(alive)
    yield f"lag of the event loop: {lag}"
    for name, value in before.items():
        yield f"{name}: {value:g} before, {after[name]:g} after"
    left = [path for path in shared if path.exists()]
    yield f"left in /dev/shm by the service that ended: {len(left)} of {len(shared)} files"


def _state(server: Server) -> dict[str, float]:
    pid = server.process.pid
    return {
        "memory of all [MB]": round(server.memory_bytes() / 1e6),
        "descriptors of the service": len(list(Path(f"/proc/{pid}/fd").iterdir())),
        "processes": len(server.processes()),
        "its files in /dev/shm": len(server.shared_files()),
    }


def _loop_lag(server: Server) -> str:
    """How often the service's own measure of its event loop exceeded some bounds."""
    return over_bounds(server.metrics(), "ikplan_event_loop_lag_seconds")


def _closed(server: Server) -> str:
    """How many connections the service closed, by reason."""
    found = re.findall(r'connections_closed_total{reason="(.+)"} (\S+)', server.metrics())
    return ", ".join(f"{reason}: {float(count):.0f}" for reason, count in found) or "none"


class _Soak:
    """One run: clients, chaos and a probe."""

    def __init__(self, server: Server, requests: int, seconds: float) -> None:
        self._server = server
        self._left = requests
        self._seconds = seconds
        self._rng = np.random.default_rng(5)
        self._helices = helices(3 * 10**6)
        self._seeds = itertools.count()
        self._ids: list[str] = []
        self._over = asyncio.Event()
        self.asked = self.kills = 0
        self.answers: Counter[int] = Counter()
        self.unanswered: Counter[str] = Counter()
        self.jobs: Counter[int] = Counter()
        self._accepted: deque[str] = deque()
        self.took_s = 0.0

    async def run(self) -> None:
        """Ask until there is nothing left to ask, or the time is over."""
        began = time.monotonic()
        others = [asyncio.create_task(t) for t in (self._kill(), self._drip())]
        following = asyncio.create_task(self._follow())
        clients = [asyncio.create_task(self._client(began)) for _ in range(_CLIENTS)]
        await asyncio.gather(*clients)
        self.took_s = time.monotonic() - began
        self._over.set()
        await asyncio.gather(*others)
        await following

    async def _follow(self) -> None:
        """Wait until every accepted job has ended, one after the other, and count how."""
        async with httpx.AsyncClient(base_url=self._server.address, timeout=120.0) as http:
            while not self._over.is_set() or self._accepted:
                if not self._accepted:
                    await asyncio.sleep(0.1)
                    continue
                place, deadline = self._accepted.popleft(), time.monotonic() + _JOBS_S
                while (status := (await http.get(place)).status_code) == 202:
                    if time.monotonic() > deadline:
                        self.unanswered["job"] += 1
                        break
                    await asyncio.sleep(0.1)
                self.jobs[status] += 1

    async def _client(self, began: float) -> None:
        acts: list[Act] = [
            self._plan, self._plan, self._timing, self._fk, self._ik, self._export, self._job,
            self._delete, self._batch, self._wrong, self._leave, self._list,
        ]  # fmt: skip
        async with httpx.AsyncClient(base_url=self._server.address, timeout=120.0) as http:
            while self._left > 0 and time.monotonic() - began < self._seconds:
                self._left -= 1
                act = acts[int(self._rng.integers(len(acts)))]
                try:
                    answer = await act(http)
                except httpx.HTTPError as error:
                    self.unanswered[f"{act.__name__}: {type(error).__name__}"] += 1
                    continue
                finally:
                    self.asked += 1
                self.answers[answer.status_code] += 1
                if answer.status_code not in _EXPECTED:
                    self.unanswered[f"{act.__name__}: {answer.status_code}"] += 1
                if place := answer.headers.get("content-location"):
                    self._ids = [*self._ids[-50:], place]

    async def _plan(self, http: httpx.AsyncClient) -> httpx.Response:
        return await http.post("/v1/plans", json=json.loads(next(self._helices)))

    async def _timing(self, http: httpx.AsyncClient) -> httpx.Response:
        q = (self._rng.random((3, 6)) - 0.5).tolist()
        return await http.post("/v1/timings", json={"robot": "ur5", "waypoints": q})

    async def _fk(self, http: httpx.AsyncClient) -> httpx.Response:
        q = self._rng.random(6).tolist()
        return await http.post("/v1/fk", json={"robot": "ur5", "q": q})

    async def _ik(self, http: httpx.AsyncClient) -> httpx.Response:
        position = (0.4 + 0.1 * self._rng.random(3)).tolist()
        return await http.post("/v1/ik", json={"robot": "iiwa14", "position": position})

    async def _export(self, http: httpx.AsyncClient) -> httpx.Response:
        place = self._ids[-1] if self._ids else "/v1/plans/none"
        return await http.get(place, headers={"accept": "text/csv"})

    async def _job(self, http: httpx.AsyncClient) -> httpx.Response:
        document = json.loads(next(self._helices))
        answer = await self._submitted(http, document)
        if answer.status_code == 202:
            self._accepted.append(answer.headers["location"])
        return answer

    async def _delete(self, http: httpx.AsyncClient) -> httpx.Response:
        """Delete a plan while it is asked for."""
        document = json.loads(next(self._helices))
        accepted = await self._submitted(http, document)
        place = accepted.headers.get("location", "/v1/plans/none")
        asking = asyncio.create_task(http.post("/v1/plans", json=document))
        await http.delete(place)
        return await asking

    async def _submitted(self, http: httpx.AsyncClient, document: object) -> httpx.Response:
        return await http.post("/v1/plans", json=document, headers={"prefer": "respond-async"})

    async def _batch(self, http: httpx.AsyncClient) -> httpx.Response:
        lines = b"\n".join(itertools.islice(self._helices, 3))
        return await http.post("/v1/batches", content=lines, headers=_NDJSON)

    async def _wrong(self, http: httpx.AsyncClient) -> httpx.Response:
        return await http.post("/v1/plans", json={"robot": "ur5", "x" * 1000: [None] * 1000})

    async def _leave(self, http: httpx.AsyncClient) -> httpx.Response:
        """Leave in the middle of a plan; then ask something short."""
        with contextlib.suppress(httpx.TimeoutException):
            document = json.loads(next(self._helices))
            await http.post("/v1/plans", json=document, timeout=0.02)
        return await http.get("/version")

    async def _list(self, http: httpx.AsyncClient) -> httpx.Response:
        return await http.get("/v1/robots")

    async def _kill(self) -> None:
        while not self._over.is_set():
            await asyncio.sleep(_KILL_EVERY_S)
            workers = await asyncio.to_thread(self._server.workers)
            if workers and self._left > 0:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(workers[int(self._rng.integers(len(workers)))], signal.SIGKILL)
                    self.kills += 1

    async def _drip(self) -> None:
        host, port = self._server.address.removeprefix("http://").split(":")
        open_now: list[socket.socket] = []
        while not self._over.is_set():
            made = socket.create_connection((host, int(port)), timeout=5)
            made.sendall(b"POST /v1/plans HTTP/1.1\r\nHost: localhost\r\n")
            open_now.append(made)
            for old in open_now[:-_SLOW_CLIENTS]:
                old.close()
            open_now = open_now[-_SLOW_CLIENTS:]
            await asyncio.sleep(0.05)
        for each in open_now:
            each.close()
