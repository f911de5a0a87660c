"""How a worker hands a long document to the service: in memory that both have open.

What goes through a worker's pipe is copied and cut into pieces several times on its way, by
threads that get into each other's way, which takes milliseconds for a plan.
"""

from __future__ import annotations

import os
import socket
import tempfile
from typing import BinaryIO

__all__ = ["receive", "send"]


def send(connection: socket.socket, document: bytes) -> None:
    """Hand a document over.

    Args:
        connection: One end of a pair of Unix sockets.
        document: The document.

    Raises:
        OSError: There is no memory for it, or nobody at the other end.
    """
    with _memory() as file:
        file.write(document)
        file.flush()
        socket.send_fds(connection, [b"\0"], [file.fileno()])


def receive(connection: socket.socket) -> bytes:
    """Take a document that was sent before.

    Args:
        connection: The other end of the pair.

    Raises:
        OSError: None was sent.
    """
    _, descriptors, _, _ = socket.recv_fds(connection, 1, 1)
    if not descriptors:
        raise ConnectionError("nobody is at the other end")
    (descriptor,) = descriptors
    try:
        return os.pread(descriptor, os.fstat(descriptor).st_size, 0)
    finally:
        os.close(descriptor)


def _memory() -> BinaryIO:
    """A file without a name, in memory where the system has that: gone with who has it open."""
    if hasattr(os, "memfd_create"):
        return open(os.memfd_create("ikplan"), "wb")
    return tempfile.TemporaryFile()
