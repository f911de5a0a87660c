"""The command that serves, in a process of its own, with settings and limits of a test."""

from __future__ import annotations

import contextlib
import http.client
import os
import re
import resource
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import httpx

WAIT_S = 120.0
"""Longest wait for what is to happen, on a machine that others use too [s]."""


class Served:
    """A running service.

    Attributes:
        process: Its process.
        address: Its address, such as ``http://127.0.0.1:4711``.
        lines: What it has logged.
    """

    def __init__(self, process: subprocess.Popen[str], address: str, lines: list[str]) -> None:
        self.process = process
        self.address = address
        self.lines = lines

    @property
    def place(self) -> tuple[str, int]:
        host, port = self.address.removeprefix("http://").split(":")
        return host, int(port)

    def wait_until_ready(self) -> None:
        deadline = time.monotonic() + WAIT_S
        with httpx.Client(base_url=self.address) as client:
            while client.get("/readyz").status_code != 200:
                assert time.monotonic() < deadline, "".join(self.lines)
                time.sleep(0.05)


@contextlib.contextmanager
def serve(*, descriptors: int = 0, workers: int = 1, **settings: str | float) -> Iterator[Served]:
    """Run ``ikplan serve`` with settings such as ``header_s=1``; kill it in the end."""

    def limit() -> None:
        if descriptors:
            resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))

    given = {"store_path": ":memory:", "log_format": "json", **settings}
    environment = os.environ | {f"IKPLAN_{k.upper()}": str(v) for k, v in given.items()}
    command = [sys.executable, "-m", "ikplan", "serve", "--port", "0", "--workers", str(workers)]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, env=environment, preexec_fn=limit
    )
    assert process.stderr is not None
    overdue = threading.Timer(WAIT_S, process.kill)
    overdue.start()
    lines: list[str] = []
    try:
        for line in process.stderr:
            lines.append(line)
            if match := re.search(r"http://127\.0\.0\.1:\d+", line):
                break
        else:
            raise AssertionError("".join(lines))
        overdue.cancel()
        reading = threading.Thread(target=lines.extend, args=(process.stderr,), daemon=True)
        reading.start()
        yield Served(process, match[0], lines)
        process.kill()
        reading.join(WAIT_S)
    finally:
        overdue.cancel()
        process.kill()
        process.wait()
        process.stderr.close()


def bound_s(quiet_s: float = 0.5) -> float:
    """The most that an answer may take: longer than on a quiet machine if others use it [s]."""
    return quiet_s * max(1.0, 2 * os.getloadavg()[0] / (os.cpu_count() or 1))


class Prober:
    """Asks ``/livez`` on new connections until it is closed, and keeps the slowest answer."""

    def __init__(self, address: str) -> None:
        self.worst = 0.0
        self.asked = 0
        self.faults: list[str] = []
        self._place = address.removeprefix("http://")
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._ask)

    def _ask(self) -> None:
        while not self._ended.wait(0.01):
            began = time.perf_counter()
            asking = http.client.HTTPConnection(self._place, timeout=30.0)
            try:
                asking.request("GET", "/livez")
                status = asking.getresponse().status
                if status != 200:
                    self.faults.append(str(status))
            except (OSError, http.client.HTTPException) as error:
                self.faults.append(repr(error))
            finally:
                asking.close()
            self.worst = max(self.worst, time.perf_counter() - began)
            self.asked += 1

    def __enter__(self) -> Prober:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
