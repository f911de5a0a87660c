"""The line from the service to one worker: tasks go one way, answers come back, in one piece each.

A process pool hands each of them on from thread to thread on the way, which costs more than reading
the request and writing the answer of a plan. Here the event loop itself writes to the worker and
hears from it.
"""

from __future__ import annotations

import asyncio
import socket
import struct
from collections.abc import Callable
from typing import Any

__all__ = ["TaskLine", "hear", "say"]

_HEAD = struct.Struct("<QQ")
"""Number and length of a message."""
_PIECE = 1 << 16


def say(connection: socket.socket, number: int, message: bytes) -> None:
    """Send a message with its number, from a worker.

    Raises:
        OSError: The service is gone.
    """
    connection.sendall(_HEAD.pack(number, len(message)) + message)


def hear(connection: socket.socket, begun: Callable[[int], None]) -> tuple[int, bytes]:
    """Wait for a message, in a worker.

    Args:
        connection: The worker's end of the line.
        begun: Called with the number of the message as soon as it begins to arrive.

    Returns:
        Its number and the message.

    Raises:
        OSError: The service is gone.
    """
    number, length = _HEAD.unpack(_exactly(connection, _HEAD.size))
    begun(number)
    return number, _exactly(connection, length)


def _exactly(connection: socket.socket, length: int) -> bytes:
    received = bytearray()
    while len(received) < length:
        piece = connection.recv(min(length - len(received), 16 * _PIECE))
        if not piece:
            raise ConnectionError("the other end is closed")
        received += piece
    return bytes(received)


class TaskLine:
    """The service's end of a line, and the one that the worker gets.

    Attributes:
        there: The worker's end.
    """

    def __init__(self) -> None:
        self._here, self.there = socket.socketpair()
        self._here.setblocking(False)
        self._heard = bytearray()
        self._answer: asyncio.Future[bytes] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None

    async def ask(self, number: int, message: bytes) -> bytes:
        """Send a message and return the answer to it.

        Raises:
            OSError: The other end is closed.
            Exception: What :meth:`give_up` was called with meanwhile.
        """
        loop = asyncio.get_running_loop()
        self._answer = loop.create_future()
        loop.add_reader(self._here, self._hear, number)
        self._loop = loop
        try:
            await self._send(_HEAD.pack(number, len(message)) + message)
            return await self._answer
        finally:
            self._answer = None
            self._stop_listening()

    def _stop_listening(self) -> None:
        """Leave the loop, before the number of the socket can be that of another one."""
        if self._loop is not None:
            self._loop.remove_reader(self._here)
            self._loop = None

    async def _send(self, message: bytes) -> None:
        """Send a message; one that does not fit into the buffer, until the answer is given up."""
        assert self._answer is not None
        try:
            sent = self._here.send(message)
        except BlockingIOError:
            sent = 0
        if sent == len(message):
            return
        loop = asyncio.get_running_loop()
        sending = loop.create_task(loop.sock_sendall(self._here, memoryview(message)[sent:]))
        try:
            either: set[asyncio.Future[Any]] = {sending, self._answer}
            await asyncio.wait(either, return_when=asyncio.FIRST_COMPLETED)
            if sending.done():
                sending.result()
        finally:
            sending.cancel()

    def give_up(self, why: BaseException) -> None:
        """End the wait for an answer."""
        if self._answer is not None and not self._answer.done():
            self._answer.set_exception(why)

    def _hear(self, number: int) -> None:
        """Take what has arrived; the answer is complete at its announced length."""
        try:
            piece = self._here.recv(16 * _PIECE)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            self.give_up(error)
            return
        if not piece:
            self.give_up(ConnectionError("the other end is closed"))
            return
        self._heard += piece
        if len(self._heard) < _HEAD.size:
            return
        told, length = _HEAD.unpack_from(self._heard)
        if len(self._heard) < _HEAD.size + length:
            return
        message = bytes(self._heard[_HEAD.size : _HEAD.size + length])
        self._heard.clear()
        if told != number:
            self.give_up(ConnectionError(f"an answer to {told} in the place of one to {number}"))
        elif self._answer is not None and not self._answer.done():
            self._answer.set_result(message)

    def close(self) -> None:
        """Close both ends, and end the wait for an answer."""
        self.give_up(ConnectionError("the line is closed"))
        self._stop_listening()
        for end in (self._here, self.there):
            end.close()
