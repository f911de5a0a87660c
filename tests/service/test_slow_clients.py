"""Clients that send or take slowly, or hold many connections, against ``ikplan serve``."""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Callable, Iterator

import httpx
import pytest

from .bad_requests import GOOD
from .serving import WAIT_S, Prober, Served, bound_s, serve

HEAD = b"POST /v1/plans HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
BODY = HEAD + b"Content-Length: 100000\r\n\r\n"
HEADER_S, BODY_S = 1.0, 2.0


@pytest.fixture(scope="module")
def small() -> Iterator[Served]:
    """A service that may open 256 files, with short time limits."""
    with serve(descriptors=256, header_s=HEADER_S, body_s=BODY_S) as running:
        running.wait_until_ready()
        yield running


@contextlib.contextmanager
def clients(place: tuple[str, int], count: int, sent: bytes) -> Iterator[list[socket.socket]]:
    with contextlib.ExitStack() as stack:
        made = []
        for _ in range(count):
            made.append(stack.enter_context(socket.create_connection(place, timeout=WAIT_S)))
            with contextlib.suppress(ConnectionError):  # closed for a newer one already
                made[-1].sendall(sent)
        yield made


def ended(client: socket.socket, within_s: float) -> bytes:
    """What a client was told until the service closed its connection."""
    client.settimeout(within_s)
    told = b""
    try:
        while piece := client.recv(65536):
            told += piece
    except ConnectionError:
        pass
    return told


@pytest.mark.parametrize("sent", [HEAD, BODY + b"{", b""], ids=["header", "body", "nothing"])
def test_three_hundred_slow_clients_keep_nobody_out_and_are_closed(
    small: Served, sent: bytes
) -> None:
    with Prober(small.address) as prober, clients(small.place, 300, sent) as slow:
        began = time.monotonic()
        told = [ended(client, HEADER_S + BODY_S + bound_s(5.0)) for client in slow]
        assert time.monotonic() - began < HEADER_S + BODY_S + bound_s(5.0)
    assert not prober.faults
    assert prober.worst <= bound_s()
    assert prober.asked > 5
    # Some gave way to newer ones; the others receive the reason, or were silent themselves.
    if sent:
        assert sum(b" 408 " in answer for answer in told) > 50
    if sent == HEAD:
        assert any(b"the header took longer than 1 s" in answer for answer in told)
        assert b"x-content-type-options" in max(told, key=len)


def test_a_fast_body_may_take_longer_than_a_slow_one(small: Served) -> None:
    length = 400_000
    with clients(small.place, 1, HEAD + b"Content-Length: %d\r\n\r\n" % length) as (client,):
        for _ in range(10):  # in 4 s, at 100 kB/s
            client.sendall(b" " * (length // 10))
            time.sleep(0.4)
        assert b" 422 " in client.recv(65536)


def drip(client: socket.socket, piece: bytes, seconds: float) -> bytes:
    """Send a byte now and then, until the service closes or the time is over."""
    client.settimeout(0.1)
    deadline, told = time.monotonic() + seconds, b""
    while time.monotonic() < deadline:
        try:
            client.sendall(piece)
            got = client.recv(65536)
            if not got:
                return told
            told += got
        except TimeoutError:
            continue
        except ConnectionError:
            return told
    raise AssertionError("still open")


@pytest.mark.parametrize(
    ("first", "piece", "within_s"),
    [
        (HEAD, b"a: b\r\n", HEADER_S),
        (BODY, b" ", BODY_S),
        (HEAD + b"Transfer-Encoding: chunked\r\n\r\n", b"1\r\n \r\n", BODY_S),
        # A body that nobody wants, after the answer.
        (b"GET /livez HTTP/1.1\r\nHost: a\r\nContent-Length: 9999\r\n\r\n", b" ", BODY_S),
        # A second request on the connection, never finished.
        (b"GET /livez HTTP/1.1\r\nHost: a\r\n\r\nGET", b"x", HEADER_S),
    ],
)
def test_a_client_that_drips_is_closed(
    small: Served, first: bytes, piece: bytes, within_s: float
) -> None:
    with clients(small.place, 1, first) as (client,):
        drip(client, piece, within_s + bound_s(3.0))


def test_a_slow_body_is_one_line_of_the_log_and_no_traceback(small: Served) -> None:
    with clients(small.place, 1, BODY) as (client,):
        assert b" 408 " in ended(client, BODY_S + bound_s(5.0))
    deadline = time.monotonic() + WAIT_S
    while not any('"status": 408' in line for line in small.lines):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert not [line for line in small.lines if "Traceback" in line]


def test_what_is_no_http_gets_a_problem_document(small: Served) -> None:
    with clients(small.place, 1, b"\x00\x01\r\n\r\n") as (client,):
        told = ended(client, 5)
    assert told.startswith(b"HTTP/1.1 400 ")
    assert b"application/problem+json" in told
    assert b"content-security-policy" in told


def test_honest_requests_are_served_during_an_attack(small: Served) -> None:
    asked: list[Callable[[httpx.Client], httpx.Response]] = [
        lambda http: http.post("/v1/plans", json=GOOD),
        lambda http: http.get("/v1/robots"),
    ]
    with clients(small.place, 150, HEAD), clients(small.place, 150, BODY):
        for ask in asked:
            with httpx.Client(base_url=small.address, timeout=60) as http:
                assert ask(http).status_code == 200
    figures = httpx.get(f"{small.address}/metrics").text
    assert 'ikplan_connections_closed_total{reason="evicted"}' in figures
    assert 'ikplan_connections_closed_total{reason="slow-header"}' in figures
