"""HTTP/1.1 connections that end in bounded time, however slow their client is."""

from __future__ import annotations

import asyncio
import json
import logging
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from ikplan_api.connections.registry import (
    LEAST_RATE,
    ConnectionLimits,
    Connections,
    Phase,
)
from ikplan_api.http.problems import PROBLEM, http_problem
from ikplan_api.http.security_headers import SECURITY_HEADERS

__all__ = ["BoundedProtocol"]

_log = logging.getLogger("ikplan.service")


class BoundedProtocol(H11Protocol):
    """Adds time limits to uvicorn's connections, and reports them to their registry.

    The registry comes from the lifespan of the application, as ``connections`` of its state.

    * A header must arrive within ``header_s``, from the first byte, or from the connection.
    * A body must arrive within ``body_s`` and the time that its bytes take at ``LEAST_RATE``.
    * A client must take ``LEAST_RATE`` of its answer while the service waits to send more.
    """

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        found: Connections | None = self.app_state.get("connections")
        self._registry = Connections(ConnectionLimits()) if found is None else found
        self._limits = self._registry.limits
        self._phase = Phase.HEADER
        self._since = 0.0
        self._body_bytes = 0
        self._timer: asyncio.TimerHandle | None = None
        self._send_timer: asyncio.TimerHandle | None = None
        self._any_request = False
        self.last_heard = 0.0

    @property
    def address(self) -> str:
        """Address of the client."""
        return self.client[0] if self.client else ""

    @property
    def phase(self) -> Phase:
        """What the connection waits for."""
        return self._phase

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Start the time limit of the first header."""
        super().connection_made(transport)
        self.last_heard = self.loop.time()
        self._enter(Phase.HEADER)
        self._registry.admit(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        super().connection_lost(exc)
        self._registry.discard(self)
        for timer in (self._timer, self._send_timer):
            if timer is not None:
                timer.cancel()
        self._timer = self._send_timer = None

    def data_received(self, data: bytes) -> None:
        """Read data, and see what is missing still."""
        self.last_heard = self.loop.time()
        super().data_received(data)
        self._body_bytes += len(data)
        self._see()

    def on_response_complete(self) -> None:
        """See what comes next on the connection."""
        super().on_response_complete()
        if self.transport.is_closing():
            self._watch_sending()
        self._see()

    def pause_writing(self) -> None:
        """Wait for the client to take its answer, but not for ever."""
        super().pause_writing()
        self._watch_sending()

    def resume_writing(self) -> None:
        """Go on sending."""
        super().resume_writing()
        if self._send_timer is not None and not self.transport.is_closing():
            self._send_timer.cancel()
            self._send_timer = None

    def timeout_keep_alive_handler(self) -> None:
        """End an idle connection, even if the end of its last answer was never taken."""
        self.transport.abort()

    def send_400_response(self, msg: str) -> None:
        """Answer what is no HTTP by a problem document."""
        self._answer(400, msg)

    def evict(self) -> None:
        """Close the connection in favour of a newer one."""
        if self._phase is Phase.BODY:
            self._give_up(503, "the service has no room for slow uploads; try again")
        else:
            self.transport.abort()

    def refuse(self) -> None:
        """Close the connection because the service has no room for it."""
        self._answer(503, "too many connections; try again", retry_after_s=1)

    def _see(self) -> None:
        """Enter the phase that the state of the connection means."""
        if self.transport.is_closing():
            return
        state = self.conn.their_state
        if state is h11.SEND_BODY:
            self._any_request = True
            self._enter(Phase.BODY)
        elif state is not h11.IDLE:
            self._any_request = True
            self._enter(Phase.ANSWER)
        elif self._any_request and not self.conn.trailing_data[0]:
            self._enter(Phase.IDLE)
        else:
            self._enter(Phase.HEADER)

    def _enter(self, phase: Phase) -> None:
        if phase is self._phase and self._timer is not None:
            return
        self._phase, self._since, self._body_bytes = phase, self.loop.time(), 0
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if phase is not Phase.ANSWER:
            self._timer = self.loop.call_at(self._deadline(), self._check)

    def _deadline(self) -> float:
        if self._phase is Phase.HEADER:
            return self._since + self._limits.header_s
        if self._phase is Phase.BODY:
            return self._since + self._limits.body_s + self._body_bytes / LEAST_RATE
        # uvicorn's own limit ends it before, unless blank lines keep it open.
        return self._since + self.timeout_keep_alive + 1.0

    def _check(self) -> None:
        """End the connection if its client is late."""
        deadline = self._deadline()
        if self.loop.time() < deadline:
            self._timer = self.loop.call_at(deadline, self._check)
            return
        self._timer = None
        if self.transport.is_closing():
            return
        self._registry.closed[f"slow-{self._phase.value}"] += 1
        if self._phase is Phase.HEADER and self.conn.trailing_data[0]:
            self._answer(408, f"the header took longer than {self._limits.header_s:g} s")
        elif self._phase is Phase.BODY:
            self._give_up(408, f"the body took longer than {self._limits.body_s:g} s")
        else:
            self.transport.abort()

    def _give_up(self, status: int, detail: str) -> None:
        """End a request whose body is not complete."""
        if self.cycle.response_started:
            self.transport.abort()
            return
        self.scope["state"]["given_up"] = status
        self.cycle.disconnected = True  # for the application
        self.cycle.message_event.set()
        self._answer(status, detail)

    def _answer(self, status: int, detail: str, retry_after_s: int | None = None) -> None:
        """Send a problem document and close the connection."""
        body = json.dumps(http_problem(status, detail)).encode()
        headers = {
            **SECURITY_HEADERS,
            "content-type": PROBLEM,
            "content-length": str(len(body)),
            "connection": "close",
        }
        if retry_after_s is not None:
            headers["retry-after"] = str(retry_after_s)
        try:
            for event in (
                h11.Response(status_code=status, headers=list(headers.items())),
                h11.Data(data=body),
                h11.EndOfMessage(),
            ):
                self.transport.write(self.conn.send(event) or b"")
        except h11.LocalProtocolError:  # an answer is under way already
            self.transport.abort()
            return
        self.transport.close()
        self._watch_sending()

    def _watch_sending(self) -> None:
        if self._send_timer is None:
            self._send_timer = self.loop.call_later(
                self._limits.send_s, self._check_sent, self.transport.get_write_buffer_size()
            )

    def _check_sent(self, before: int) -> None:
        """End the connection if its client took hardly anything of what it is sent."""
        self._send_timer = None
        left = self.transport.get_write_buffer_size()
        if left and before - left < min(before, LEAST_RATE * self._limits.send_s):
            self._registry.closed["slow-answer"] += 1
            self.transport.abort()
        elif left:
            self._watch_sending()
