"""Transfer of long documents from a worker to the service in shared memory.

A worker's pipe copies and splits a message several times in competing threads, which takes
milliseconds for a plan. Both ends keep the memory from one document to the next: the system clears
every page of new memory, which takes several times as long as writing a plan to it.
"""

from __future__ import annotations

import os
import socket
import struct
import tempfile
from typing import BinaryIO

__all__ = ["KEPT", "DocumentReceiver", "DocumentSender"]

KEPT = 4 * 2**20
"""Longest document in the memory that both ends keep [bytes]; a longer one has its own."""
_NUMBER = struct.Struct("<Q")
"""Number of a document, in front of it."""


class DocumentSender:
    """The worker's end.

    Args:
        connection: The socket :attr:`DocumentReceiver.there`.
    """

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._kept: BinaryIO | None = None
        self._sent = 0

    def send(self, document: bytes) -> None:
        """Send a document; the receiver has to read it before the next one is sent.

        Raises:
            OSError: There is not enough memory, or the other end is closed.
        """
        if len(document) > KEPT:
            with _memory() as file:
                self._write(file, document)
                self._hand_over(file)
        elif self._kept is None:
            file = _memory()
            try:
                self._write(file, document)
                self._hand_over(file)
            except OSError:
                file.close()
                raise
            self._kept = file
        else:
            self._write(self._kept, document)
        self._sent += 1

    def _write(self, file: BinaryIO, document: bytes) -> None:
        file.seek(0)
        file.write(_NUMBER.pack(self._sent + 1))
        file.write(document)
        file.flush()

    def _hand_over(self, file: BinaryIO) -> None:
        socket.send_fds(self._connection, [b"\0"], [file.fileno()])

    def close(self) -> None:
        """Give the memory back."""
        if self._kept is not None:
            self._kept.close()
            self._kept = None


class DocumentReceiver:
    """The service's end.

    Attributes:
        there: The worker's end of the pair of sockets over which memory is handed over.
    """

    def __init__(self) -> None:
        self._here, self.there = socket.socketpair()
        self._here.setblocking(False)
        self._kept: int | None = None
        self._received = 0

    def receive(self, length: int) -> bytes:
        """Receive a document that was sent before.

        Args:
            length: Its length [bytes].

        Raises:
            OSError: No document was sent, or another one.
        """
        if length > KEPT:
            descriptor = self._handed_over()
            try:
                return self._read(descriptor, length)
            finally:
                os.close(descriptor)
        if self._kept is None:
            self._kept = self._handed_over()
        return self._read(self._kept, length)

    def _handed_over(self) -> int:
        _, descriptors, _, _ = socket.recv_fds(self._here, 1, 1)
        if not descriptors:
            raise ConnectionError("the other end is closed")
        (descriptor,) = descriptors
        return descriptor

    def _read(self, descriptor: int, length: int) -> bytes:
        (number,) = _NUMBER.unpack(os.pread(descriptor, _NUMBER.size, 0))
        if number != self._received + 1:
            raise ConnectionError(f"document {number} in the place of {self._received + 1}")
        document = os.pread(descriptor, length, _NUMBER.size)
        if len(document) != length:
            raise ConnectionError(f"{len(document)} of {length} bytes of a document")
        self._received = number
        return document

    def close(self) -> None:
        """Close both ends, and give the memory back."""
        if self._kept is not None:
            os.close(self._kept)
            self._kept = None
        for end in (self._here, self.there):
            end.close()


def _memory() -> BinaryIO:
    """Open a file without a name, in memory if the system supports it; closing it deletes it."""
    if hasattr(os, "memfd_create"):
        return open(os.memfd_create("ikplan"), "wb")
    return tempfile.TemporaryFile()
