"""Request ids, and problem documents for unexpected failures."""

from __future__ import annotations

import asyncio
import re
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ikplan.errors import ServiceUnavailable
from ikplan_api.http.problems import error_response, http_problem, problem_response
from ikplan_api.telemetry import logs

__all__ = ["RequestIdMiddleware"]

_STOPPING_RETRY_S = 5.0
"""Time after which a service that stops may have been replaced [s]."""
_HEADER = "x-request-id"
_ACCEPTED = re.compile(r"[A-Za-z0-9._-]{1,64}")


class RequestIdMiddleware:
    """Gives every request an id and answers unexpected failures with a problem document.

    The id is the client's ``X-Request-ID`` if that is well formed, else a new one. Every response
    and every problem document contains it.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        given = Headers(scope=scope).get(_HEADER, "")
        request_id = given if _ACCEPTED.fullmatch(given) else uuid.uuid4().hex
        scope.setdefault("state", {})["request_id"] = request_id
        token = logs.request_id.set(request_id)
        started = False

        async def send_with_id(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                MutableHeaders(scope=message)[_HEADER] = request_id
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        except asyncio.CancelledError:
            # The server stops, and its time for requests in progress is over.
            if started:
                raise
            error = ServiceUnavailable(
                "the service is stopping",
                status_code=ServiceUnavailable.status,
                retry_after_s=_STOPPING_RETRY_S,
            )
            await error_response(Request(scope), error)(scope, receive, send_with_id)
        except Exception:
            if not started:
                detail = "unexpected error in the service; please report it with this id"
                answer = problem_response(http_problem(500, detail), request_id)
                await answer(scope, receive, send_with_id)
            raise  # for the server to log
        finally:
            logs.request_id.reset(token)
