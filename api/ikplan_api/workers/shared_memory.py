"""Transfer of long documents from a worker to the service in shared memory.

A worker's pipe copies and splits a message several times in competing threads, which takes
milliseconds for a plan.
"""

from __future__ import annotations

import os
import socket
import tempfile
from typing import BinaryIO

__all__ = ["receive", "send"]


def send(connection: socket.socket, document: bytes) -> None:
    """Send a document.

    Args:
        connection: One end of a pair of Unix sockets.
        document: The document.

    Raises:
        OSError: There is not enough memory, or the other end is closed.
    """
    with _memory() as file:
        file.write(document)
        file.flush()
        socket.send_fds(connection, [b"\0"], [file.fileno()])


def receive(connection: socket.socket) -> bytes:
    """Receive a document that was sent before.

    Args:
        connection: The other end of the pair.

    Raises:
        OSError: No document was sent.
    """
    _, descriptors, _, _ = socket.recv_fds(connection, 1, 1)
    if not descriptors:
        raise ConnectionError("the other end is closed")
    (descriptor,) = descriptors
    try:
        return os.pread(descriptor, os.fstat(descriptor).st_size, 0)
    finally:
        os.close(descriptor)


def _memory() -> BinaryIO:
    """Open a file without a name, in memory if the system supports it; closing it deletes it."""
    if hasattr(os, "memfd_create"):
        return open(os.memfd_create("ikplan"), "wb")
    return tempfile.TemporaryFile()
