"""Documents handed from one process to another in shared memory."""

from __future__ import annotations

import multiprocessing
import os
import socket

import pytest

from ikplan_api.workers import shared_memory


def _hand_over(connection: socket.socket, documents: list[bytes]) -> None:
    for document in documents:
        shared_memory.send(connection, document)


def _open_files() -> int:
    return len(os.listdir("/proc/self/fd"))


def test_documents_arrive_as_they_were_sent_in_their_order() -> None:
    documents = [b"", b"{}", os.urandom(3_000_000), b"x"]
    here, there = socket.socketpair()
    with here, there:
        process = multiprocessing.get_context("spawn").Process(
            target=_hand_over, args=(there, documents)
        )
        process.start()
        process.join(60)
        assert [shared_memory.receive(here) for _ in documents] == documents


def test_nothing_stays_open() -> None:
    here, there = socket.socketpair()
    with here, there:
        before = _open_files()
        for _ in range(50):
            shared_memory.send(there, b"document")
            shared_memory.receive(here)
        assert _open_files() == before


def test_nothing_sent_is_a_fault_not_an_empty_document() -> None:
    here, there = socket.socketpair()
    with here, there:
        here.setblocking(False)
        with pytest.raises(BlockingIOError):
            shared_memory.receive(here)
        there.close()
        with pytest.raises(ConnectionError):
            shared_memory.receive(here)
