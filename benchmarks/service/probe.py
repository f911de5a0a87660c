"""How long ``/livez`` takes, asked by a process that does nothing else."""

from __future__ import annotations

import http.client
import multiprocessing
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from urllib.parse import urlsplit

__all__ = ["probing"]

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
