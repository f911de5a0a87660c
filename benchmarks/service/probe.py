"""How long ``/livez`` takes, asked by a process that does nothing else."""

from __future__ import annotations

import http.client
import math
import multiprocessing
import re
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from urllib.parse import urlsplit

__all__ = ["over_bounds", "probing", "told"]

_EVERY_S = 0.1


@contextmanager
def probing(address: str) -> Iterator[list[float]]:
    """Ask all the time.

    Args:
        address: Address of the service.

    Yields:
        A list that has the times of all answers [s], sorted, when it is over.
    """
    times: list[float] = []
    spawn = multiprocessing.get_context("spawn")
    here, there = spawn.Pipe()
    process = spawn.Process(target=_ask, args=(address, there))
    process.start()
    here.recv()
    try:
        yield times
    finally:
        here.send("enough")
        times += sorted(here.recv())
        process.join()


def _ask(address: str, control: Connection[str | list[float], str]) -> None:
    connection = http.client.HTTPConnection(urlsplit(address).netloc, timeout=60.0)
    times: list[float] = []
    control.send("asking")
    while not control.poll(_EVERY_S):
        begin = time.perf_counter()
        connection.request("GET", "/livez")
        connection.getresponse().read()
        times.append(time.perf_counter() - begin)
    control.send(times)


def told(alive: list[float]) -> str:
    """Tell the times of all answers, sorted [s]."""
    middle, late = statistics.median(alive), alive[int(0.99 * len(alive))]
    return (
        f"/livez, {len(alive)} times: median {1e3 * middle:.1f} ms, p99 {1e3 * late:.0f} ms, "
        f"longest {1e3 * alive[-1]:.0f} ms"
    )


def over_bounds(metrics: str, name: str, **labels: str) -> str:
    """Tell how many observations of a histogram exceed some bounds.

    Args:
        metrics: The metrics of the service, as text.
        name: Name of the histogram [s].
        labels: Labels that it must have.
    """
    below: dict[float, float] = {}
    for found, value in re.findall(rf"^{name}_bucket{{(.*)}} (\S+)$", metrics, re.MULTILINE):
        given = dict(re.findall(r'(\w+)="([^"]*)"', found))
        if labels.items() <= given.items():
            bound = float(given["le"])
            below[bound] = below.get(bound, 0.0) + float(value)
    count = below[math.inf]
    over = {bound: count - below[bound] for bound in (0.05, 0.1, 0.25, 0.5, 1.0, 10.0, 30.0)}
    return f"of {count:.0f}, over " + ", ".join(f"{k:g} s: {n:.0f}" for k, n in over.items())
