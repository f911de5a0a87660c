"""The server that tells the service when it is to stop, and sees to it that it does."""

from __future__ import annotations

import asyncio
import gc
import logging
import math
import os
import socket

import uvicorn

__all__ = ["Server"]

_QUEUE = 1024
"""Connections that wait to be accepted; the server's ``backlog`` is what it accepts at once."""
_LAST_BYTES_S = 1
"""Time for answers to get out, beyond that for their work [s]."""
_CLOSING_S = 5
"""Time for the service to end its workers and close its files, beyond that [s]."""

_log = logging.getLogger("uvicorn.error")


class Server(uvicorn.Server):
    """Stops in order, and in bounded time.

    uvicorn tells an application that it is to stop when all connections are closed; an event
    stream would keep one open for as long as uvicorn waits at all.
    """

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start to listen, with a queue of its own length for connections to be accepted."""
        await super().startup(sockets)
        if (prepare := self.lifespan.state.get("prepare")) is not None:
            prepare()
        # What is loaded now stays: looking for garbage in it would hold the loop for 0.1 s.
        gc.freeze()
        if (warming := self.lifespan.state.get("warming")) is not None:
            warming.add_done_callback(lambda _: gc.freeze())
        for listening in sockets or ():
            listening.listen(_QUEUE)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Tell the service to stop, and give requests under way the time that it says."""
        stop = self.lifespan.state.get("stop")
        last_s = math.ceil(stop() if stop is not None else 0.0) + _LAST_BYTES_S
        self.config.timeout_graceful_shutdown = last_s
        warming = self.lifespan.state.get("warming")
        # Who waits for an answer still gets one.
        idle = warming is not None and not (warming.done() or self.server_state.tasks)
        try:
            async with asyncio.timeout(_LAST_BYTES_S if idle else last_s + _CLOSING_S):
                await super().shutdown(sockets)
        except TimeoutError:
            # Nothing is lost that a kill would not lose: what is kept is on the disk, and workers
            # end with their service. One that still loads its kernels cannot end before.
            if idle:
                _log.info("stopped before it was ready")
            else:
                _log.error("the service did not end in time, and is ended")
            logging.shutdown()
            os._exit(0 if idle else 1)
