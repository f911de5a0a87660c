"""The server that tells the service when it is to stop."""

from __future__ import annotations

import asyncio
import math
import socket

import uvicorn

__all__ = ["Server"]

_LAST_BYTES_S = 1
"""Time for answers to get out, beyond that for their work [s]."""


class Server(uvicorn.Server):
    """Stops in order: what would never end by itself is ended first.

    uvicorn tells an application that it is to stop when all connections are closed; an event
    stream would keep one open for as long as uvicorn waits at all.
    """

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Tell the service to stop, and give requests under way the time that it says."""
        stop = self.lifespan.state.get("stop")
        if stop is not None:
            self.config.timeout_graceful_shutdown = math.ceil(stop()) + _LAST_BYTES_S
            await asyncio.sleep(0)
        await super().shutdown(sockets)
