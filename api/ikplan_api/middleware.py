"""What happens around every request."""

from __future__ import annotations

import re
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ikplan_api import logs
from ikplan_api.problems import http_problem, problem_response

__all__ = ["RequestIdMiddleware"]

_HEADER = "x-request-id"
_ACCEPTED = re.compile(r"[A-Za-z0-9._-]{1,64}")


class RequestIdMiddleware:
    """Gives every request an id, and every failure that nobody foresaw an answer.

    The id is the caller's ``X-Request-ID`` if that is plain, else a new one; every answer
    carries it, and so does every problem document.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
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
        except Exception:
            if not started:
                detail = "an unexpected fault of the service; please report it with this id"
                answer = problem_response(http_problem(500, detail), request_id)
                await answer(scope, receive, send_with_id)
            raise  # for the server to log
        finally:
            logs.request_id.reset(token)
