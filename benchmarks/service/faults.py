"""What is lost when processes are killed and disks are full: nothing that was accepted."""

from __future__ import annotations

import itertools
import json
import os
import signal
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import ikplan
from benchmarks.service.requests import helices, slow_request
from benchmarks.service.server import Server, processor_s, serving
from ikplan.processor_time import WALL_FACTOR

__all__ = ["try_faults"]


def try_faults() -> Iterator[str]:
    """Try every fault."""
    for fault in (_worker_killed, _plan_hangs, _server_killed, _disk_full):
        yield fault()


def _worker_killed() -> str:
    with serving(workers="2") as server, ikplan.Client(server.address, retries=0) as client:
        outcome: list[str] = []

        def doomed() -> None:
            try:
                client.plan(slow_request(60.0))
            except ikplan.ServiceUnavailable as error:
                outcome.append(f"503, to be asked again after {error.retry_after_s:g} s")

        thread = threading.Thread(target=doomed)
        thread.start()
        for _ in range(2):  # the second one tries again
            time.sleep(2.0)
            os.kill(max(server.workers(), key=processor_s), signal.SIGKILL)
        begin = time.perf_counter()
        thread.join()
        told = time.perf_counter() - begin
        for body in itertools.islice(helices(), 6):
            client.plan(json.loads(body))
        count = len(server.workers())
    return (
        f"both workers of a plan killed: its caller got {outcome[0]}, after {told:.2f} s; "
        f"{count} workers again"
    )


def _plan_hangs() -> str:
    with serving(workers="1", grace_s="1") as server, ikplan.Client(server.address) as client:
        thread = threading.Thread(target=_quietly, args=(client, slow_request(2.0)))
        thread.start()
        time.sleep(1.0)
        (worker,) = server.workers()
        # Halted, it cannot look at its clock any more; let go, it has to be gone: its wall time,
        # a multiple of its budget and a grace of 1 s, is over.
        os.kill(worker, signal.SIGSTOP)
        time.sleep(WALL_FACTOR * 2.0 + 1.0)
        os.kill(worker, signal.SIGCONT)
        begin = time.perf_counter()
        thread.join()
        took = time.perf_counter() - begin
        client.plan(json.loads(next(helices())))
        gone = worker not in server.workers()
    return (
        f"plan that hangs past its budget of 2 s: stopped {took:.2f} s after it goes on; "
        f"its worker is {'replaced' if gone else 'the same'}, the next plan is made"
    )


def _quietly(client: ikplan.Client, request: dict[str, object]) -> None:
    try:
        client.plan(request)
    except ikplan.BudgetExceeded:
        return
    raise AssertionError("the plan was to exceed its budget")


def _server_killed() -> str:
    requests = [json.loads(body) for body in itertools.islice(helices(5 * 10**6), 20)]
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "store.sqlite3")
        server = Server(workers="1", store_path=path)
        try:
            server.wait_until_ready()
            with ikplan.Client(server.address) as client:
                blocker = client.submit(slow_request(3.0))
                jobs = [client.submit(request) for request in requests]
                states = [job.status().state for job in jobs]
            children = server.processes()
            server.kill()
        finally:
            server.stop()
        deadline = time.monotonic() + 10.0
        while any(Path(f"/proc/{pid}").exists() for pid in children):
            assert time.monotonic() < deadline, "a worker outlived the service"
            time.sleep(0.05)
        with serving(workers="1", store_path=path) as again:
            begin = time.perf_counter()
            with ikplan.Client(again.address) as client:
                plans = [client.job(job.id).wait(timeout=120.0) for job in jobs]
                took = time.perf_counter() - begin
                try:
                    client.job(blocker.id).wait(timeout=60.0)
                    raise AssertionError("the blocking job was to exceed its budget")
                except ikplan.BudgetExceeded:
                    pass
        assert all(plan.certificate.valid for plan in plans)
    return (
        f"service killed with {states.count('queued')} jobs queued: all {len(plans)} plans made "
        f"{took:.1f} s after the next start was ready; no process was left over"
    )


def _disk_full() -> str:
    with tempfile.TemporaryDirectory() as folder:
        if os.system(f"mount -t tmpfs -o size=2m tmpfs {folder} 2>/dev/null") != 0:
            return "disk full: not tried, a small file system cannot be mounted here"
        try:
            return _fill(str(Path(folder) / "store.sqlite3"))
        finally:
            os.system(f"umount {folder}")


def _fill(path: str) -> str:
    with (
        serving(workers="1", store_path=path) as server,
        ikplan.Client(server.address, retries=0) as client,
    ):
        made = [client.plan(json.loads(body)) for body in itertools.islice(helices(), 6)]
        try:
            for body in itertools.islice(helices(10**7), 50):
                client.submit(json.loads(body)).wait()
            refused = "no job was refused"
        except ikplan.ServiceUnavailable as error:
            refused = f"a job was refused: {error.detail!r}"
        client.plan(json.loads(next(helices(2 * 10**7))))
        found = sum(client.get_plan(plan.id).id == plan.id for plan in made[-2:])
    return f"disk of 2 MiB: {len(made)} plans answered, the last {found} of 2 found; {refused}"
