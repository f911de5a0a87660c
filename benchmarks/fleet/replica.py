"""One replica: ``ikplan serve`` in a process of its own, to be killed, halted and started again."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx

__all__ = ["Replica"]


class Replica:
    """A replica on a loopback port that stays the same over its restarts.

    Args:
        database: Address of the database.
        log: File for its log.
        lease_s: Lease of a claim [s].

    Attributes:
        address: Its address.
    """

    def __init__(self, database: str, log: Path, lease_s: float, workers: int = 1) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self._port = int(free.getsockname()[1])
        self.address = f"http://127.0.0.1:{self._port}"
        self._log = log
        self._workers = workers
        self._environment = {
            **os.environ,
            "IKPLAN_STORE_URL": database,
            "IKPLAN_LEASE_S": str(lease_s),
            "IKPLAN_LOG_FORMAT": "text",
        }
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it; it is ready some seconds later."""
        command = [sys.executable, "-m", "ikplan", "serve", "--port", str(self._port)]
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(
                [*command, "--workers", str(self._workers)], stderr=log, env=self._environment
            )

    @property
    def pid(self) -> int:
        """Its process id."""
        assert self._process is not None
        return self._process.pid

    def wait_until_ready(self, within_s: float = 900.0) -> None:
        """Wait until its workers are warm."""
        deadline = time.monotonic() + within_s
        with httpx.Client(base_url=self.address, timeout=5.0) as client:
            while True:
                with contextlib.suppress(httpx.HTTPError):
                    if client.get("/readyz").status_code == 200:
                        return
                assert time.monotonic() < deadline, f"not ready: see {self._log}"
                time.sleep(0.2)

    def kill(self) -> None:
        """End it as a lost node does, and what it started."""
        assert self._process is not None
        children = self.workers()
        self._process.send_signal(signal.SIGKILL)
        self._process.wait()
        for pid in children:  # they end by themselves; a halted one would not
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    def send(self, number: int) -> None:
        """Send it a signal, such as SIGSTOP."""
        assert self._process is not None
        self._process.send_signal(number)

    def workers(self) -> list[int]:
        """Process ids of its workers: children of its fork server."""
        parents = _parents()
        servers = [pid for pid, parent in parents.items() if parent == self.pid]
        return [pid for pid, parent in parents.items() if parent in servers]


def _parents() -> dict[int, int]:
    """Return the parent of every process that is alive."""
    found = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            fields = stat.read_text().rpartition(")")[2].split()
            if fields[0] != "Z":
                found[int(stat.parent.name)] = int(fields[1])
    return found
