"""What a plan costs over HTTP beyond what it costs in Python."""

from __future__ import annotations

import http.client
import itertools
import json
import statistics
import time
from collections.abc import Sequence
from urllib.parse import urlsplit

import ikplan
from benchmarks.service.requests import helices
from benchmarks.service.server import serving, threads_s
from benchmarks.speed.measure import FkClock
from ikplan.documents import write_json
from ikplan.robots import catalogue_robot

__all__ = ["measure_overhead"]


def measure_overhead(pairs: int = 40) -> list[str]:
    """Make each plan here and over HTTP, in turn, and compare.

    The exchange is that of Python's own http.client, which adds least of its own. On a machine
    that does other things too its wall time says little; its processor time is that of all
    processes, this one included, until the answer is read.

    Args:
        pairs: How many plans are made.

    Returns:
        Lines of the report.
    """
    here, document, exchange, client_s, beyond = [], [], [], [], []
    clock = FkClock(catalogue_robot("iiwa14"))
    own_s = spent_s = 0.0
    with (
        serving(workers="1", store_path=":memory:") as server,
        ikplan.Client(server.address) as client,
    ):
        address = urlsplit(server.address)
        connection = http.client.HTTPConnection(str(address.hostname), address.port)
        processes = server.processes()
        for k, body in enumerate(itertools.islice(helices(), pairs + 5)):
            request = json.loads(body)
            if k == 5:  # both are warm
                spent_s = server.processor_s()
            clock.tick()
            begin, own = time.perf_counter(), time.process_time()
            plan = ikplan.plan(request)
            own = time.process_time() - own
            planned = time.perf_counter()
            write_json(plan)
            processor = threads_s(processes) + time.thread_time()
            written = time.perf_counter()
            headers = {"content-type": "application/json"}
            connection.request("POST", "/v1/plans", body, headers)
            answer = connection.getresponse().read()
            answered = time.perf_counter()
            processor = time.thread_time() + threads_s(processes) - processor
            assert json.loads(answer)["id"] == plan.id
            client.job(plan.id).cancel()
            again = time.perf_counter()
            client.plan(request)
            read = time.perf_counter()
            if k >= 5:
                own_s += own
                here.append(planned - begin)
                document.append(written - begin)
                exchange.append(answered - written)
                client_s.append(read - again)
                beyond.append(processor - own)
        spent_s = server.processor_s() - spent_s
        connection.close()
    rows = (
        ("HTTP exchange over plan() alone", exchange, here),
        ("HTTP exchange over plan() and its JSON", exchange, document),
        ("Client.plan() over plan()", client_s, here),
    )
    lines = [f"plan() {1e3 * statistics.median(here):.1f} ms, median of {pairs}"]
    for name, over, under in rows:
        extra = [a - b for a, b in zip(over, under, strict=True)]
        lines.append(f"{name}: {_told(extra, clock)} (median of pairs)")
    name = "processor time of the HTTP exchange over that of plan() alone"
    lines.append(f"{name}: {_told(beyond, clock)} (median of pairs)")
    lines.append(
        f"processor time of a plan: {1e3 * own_s / pairs:.1f} ms here, "
        f"{1e3 * spent_s / (2 * pairs):.1f} ms of the service's processes"
    )
    return lines


def _told(extra: Sequence[float], clock: FkClock) -> str:
    """The median of some times, also in calls of the forward kinematics."""
    median = statistics.median(extra)
    return f"{1e3 * median:.1f} ms, {median / clock.seconds:.0f} FK"
