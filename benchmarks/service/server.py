"""A service as a process of its own, on a free port of the loopback address."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx

__all__ = ["Server", "processor_s", "serving", "threads_s"]

_READY_S = 300.0


class Server:
    """A running service.

    Attributes:
        process: The process of the service itself.
        address: Where it listens.
    """

    def __init__(self, **settings: str) -> None:
        environment = {**os.environ, **{f"IKPLAN_{k.upper()}": v for k, v in settings.items()}}
        command = [sys.executable, "-m", "ikplan", "serve", "--port", "0"]
        self.process = subprocess.Popen(
            command, stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True
        )
        assert self.process.stderr is not None
        said = ""
        for line in self.process.stderr:
            said += line
            if match := re.search(r"http://127\.0\.0\.1:\d+", line):
                self.address = match[0]
                break
        else:
            raise RuntimeError(said)
        # Nobody reads on: what it says after this must not fill the pipe.
        self._drain = subprocess.Popen(
            ["cat"], stdin=self.process.stderr, stdout=subprocess.DEVNULL
        )

    def wait_until_ready(self) -> None:
        """Wait for warm workers."""
        deadline = time.monotonic() + _READY_S
        with httpx.Client(base_url=self.address) as client:
            while time.monotonic() < deadline:
                with suppress(httpx.TransportError):
                    if client.get("/readyz").status_code == 200:
                        return
                time.sleep(0.1)
        raise TimeoutError("the service does not get ready")

    def processes(self) -> list[int]:
        """Process ids of the service and all it started."""
        return sorted(self._family())

    def _family(self) -> dict[int, int]:
        """The service and all it started, each with its parent."""
        parents = {}
        for stat in Path("/proc").glob("[0-9]*/stat"):
            with suppress(OSError):
                parents[int(stat.parent.name)] = int(stat.read_text().rpartition(")")[2].split()[1])
        family = {self.process.pid}
        while more := {pid for pid, parent in parents.items() if parent in family} - family:
            family |= more
        return {pid: parents.get(pid, 0) for pid in family}

    def workers(self) -> list[int]:
        """Process ids of the workers: children of the warm process, which the service started."""
        family = self._family()
        warm = {pid for pid in family if _command(pid).count("forkserver")}
        return sorted(pid for pid in warm if family[pid] in warm)

    def processor_s(self) -> float:
        """Processor time that the service and all it started have taken [s]."""
        return sum(processor_s(pid) for pid in self.processes())

    def memory_bytes(self) -> int:
        """Memory of the service and all it started, shared pages counted once [bytes]."""
        total = 0
        for pid in self.processes():
            with suppress(OSError):
                rollup = Path(f"/proc/{pid}/smaps_rollup").read_text()
                total += int(re.search(r"^Pss:\s+(\d+) kB", rollup, re.MULTILINE)[1]) * 1024  # type: ignore[index]
        return total

    def metrics(self) -> str:
        """What the service tells of itself, in the Prometheus text format."""
        return httpx.get(f"{self.address}/metrics", timeout=60.0).text

    def shared_files(self) -> list[Path]:
        """Files in /dev/shm that the service and all it started have mapped."""
        found: set[str] = set()
        for pid in self.processes():
            with suppress(OSError):
                found |= set(re.findall(r"/dev/shm/\S+", Path(f"/proc/{pid}/maps").read_text()))
        return sorted(Path(path) for path in found)

    def kill(self) -> None:
        """End it as a power cut would."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def stop(self) -> None:
        """End it as an operator would."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(60)
            except subprocess.TimeoutExpired:
                self.kill()
        self._drain.wait()
        assert self.process.stderr is not None
        self.process.stderr.close()


def processor_s(pid: int) -> float:
    """Processor time that a process has taken [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def threads_s(pids: Iterable[int]) -> float:
    """Processor time of the threads of some processes, of those that have not ended [s]."""
    total = 0
    for pid in pids:
        for thread in Path(f"/proc/{pid}/task").glob("*/schedstat"):
            with suppress(OSError):
                total += int(thread.read_text().split()[0])
    return 1e-9 * total


def _command(pid: int) -> str:
    with suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    return ""


@contextmanager
def serving(**settings: str) -> Iterator[Server]:
    """A warm service with these settings; it is stopped whatever happens."""
    server = Server(**settings)
    try:
        server.wait_until_ready()
        yield server
    finally:
        server.stop()
