"""Documents handed from one process to another in shared memory."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import socket
from collections.abc import Iterator

import pytest

from ikplan_api.workers.shared_memory import KEPT, DocumentReceiver, DocumentSender


@contextlib.contextmanager
def _ends() -> Iterator[tuple[DocumentSender, DocumentReceiver]]:
    with contextlib.ExitStack() as opened:
        receiver = DocumentReceiver()
        opened.callback(receiver.close)
        sender = DocumentSender(receiver.there)
        opened.callback(sender.close)
        yield sender, receiver


def _hand_over(connection: socket.socket, asked: socket.socket, documents: list[bytes]) -> None:
    with contextlib.closing(DocumentSender(connection)) as sender:
        for document in documents:
            asked.recv(1)
            sender.send(document)
            asked.send(b".")


def _open_files() -> int:
    return len(os.listdir("/proc/self/fd"))


def test_documents_arrive_as_they_were_sent_in_their_order() -> None:
    documents = [
        b"",
        b"{}",
        os.urandom(3_000_000),
        b"x",
        os.urandom(KEPT),
        os.urandom(KEPT + 1),
        os.urandom(1_000),
        os.urandom(2 * KEPT),
    ]
    receiver = DocumentReceiver()
    here, there = socket.socketpair()
    with here, there:
        process = multiprocessing.get_context("spawn").Process(
            target=_hand_over, args=(receiver.there, there, documents)
        )
        process.start()
        for document in documents:
            here.send(b".")
            assert here.recv(1) == b"."
            assert receiver.receive(len(document)) == document
        process.join(60)
    receiver.close()


def test_nothing_stays_open() -> None:
    before = _open_files()
    with _ends() as (sender, receiver):
        for k in range(50):
            document = bytes(KEPT + 1 if k % 10 == 0 else k)
            sender.send(document)
            assert receiver.receive(len(document)) == document
        assert _open_files() == before + 4  # a pair of sockets, and one memory at each end
    assert _open_files() == before


def test_nothing_sent_is_a_fault_not_an_empty_document() -> None:
    with _ends() as (_, receiver):
        for length in (0, 1, KEPT + 1):
            with pytest.raises(BlockingIOError):
                receiver.receive(length)
        receiver.there.close()
        with pytest.raises(ConnectionError):
            receiver.receive(1)


def test_a_document_is_never_read_twice() -> None:
    with _ends() as (sender, receiver):
        sender.send(b"first")
        assert receiver.receive(5) == b"first"
        with pytest.raises(ConnectionError, match="document 1 in the place of 2"):
            receiver.receive(5)
        sender.send(b"second")
        with pytest.raises(ConnectionError, match="7"):
            receiver.receive(7)
        sender.send(b"third")
        with pytest.raises(ConnectionError, match="document 3 in the place of 2"):
            receiver.receive(5)


@pytest.mark.parametrize("nth", [1, 2])
def test_a_document_that_does_not_fit_leaves_nothing_open(
    nth: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = [nth]
    send_fds = socket.send_fds

    def failing(*arguments: object) -> object:
        left[0] -= 1
        if not left[0]:
            raise OSError("no memory")
        return send_fds(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(socket, "send_fds", failing)
    before = _open_files()
    with _ends() as (sender, receiver):
        for document in (b"a", bytes(KEPT + 1), b"b", bytes(KEPT + 2)):
            with contextlib.suppress(OSError):
                sender.send(document)
                assert receiver.receive(len(document)) == document
    assert left[0] < 0
    assert _open_files() == before
