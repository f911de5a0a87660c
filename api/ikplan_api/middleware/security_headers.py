"""Security headers for browsers on every response."""

from __future__ import annotations

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ikplan_api.http.security_headers import SECURITY_HEADERS

__all__ = ["SecurityHeadersMiddleware"]

_HEADERS = [(name.encode(), value.encode()) for name, value in SECURITY_HEADERS.items()]


class SecurityHeadersMiddleware:
    """Adds security headers that a response does not set itself.

    Args:
        app: The wrapped application.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = list(message.get("headers", ()))
                own = {name.lower() for name, _ in headers}
                headers += [header for header in _HEADERS if header[0] not in own]
                message = {**message, "headers": headers}
            await send(message)

        await self._app(scope, receive, send_with_headers)
