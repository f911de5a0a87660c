"""Refusal of requests that were meant for another host, against DNS rebinding."""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from ikplan.documents.json_text import shortened
from ikplan.errors import AccessDenied
from ikplan_api.http.problems import error_response
from ikplan_api.settings.access import is_loopback

__all__ = ["HostsMiddleware", "host_name"]

_PROBES = frozenset({"/livez", "/readyz"})
"""A cluster's probes come by address; they reveal nothing and change nothing."""
_READING = frozenset({"GET", "HEAD", "OPTIONS"})


class HostsMiddleware:
    """Accepts requests for named hosts only, and writes from their own web pages only.

    A web page whose name is changed to a loopback address in the middle of a visit sends requests
    that a browser takes for its own; their ``Host`` is still that of the page.

    Args:
        app: The wrapped application.
        hosts: The names; empty: names of the loopback interface.
        origins: Further origins whose pages may write.
    """

    def __init__(self, app: ASGIApp, *, hosts: Sequence[str], origins: Sequence[str]) -> None:
        self._app = app
        self._hosts = frozenset(host.lower() for host in hosts)
        self._origins = frozenset(origins)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection, or refuse it."""
        if scope["type"] == "http" and scope["path"] not in _PROBES:
            try:
                self._check(scope)
            except AccessDenied as error:
                await error_response(Request(scope), error, 403)(scope, receive, send)
                return
        await self._app(scope, receive, send)

    def _check(self, scope: Scope) -> None:
        """Check the headers Host and Origin.

        Raises:
            AccessDenied: The host is another one, or a foreign page writes.
        """
        headers = Headers(scope=scope)
        given = headers.getlist("host")
        host = given[0].lower() if len(given) == 1 else ""
        if not self._accepted(host_name(host)):
            names = ", ".join(sorted(self._hosts)) or "loopback names"
            raise AccessDenied(
                f"the header Host is {shortened(host)!r}, and this service is asked as {names} "
                "only; its operator can name others in IKPLAN_HOSTS"
            )
        if scope["method"] in _READING:
            return
        for origin in headers.getlist("origin"):
            if origin not in self._origins and _place_of(origin) != host:
                raise AccessDenied(
                    f"the header Origin is {shortened(origin)!r}: pages of other origins may not "
                    "write; the operator can name them in IKPLAN_CORS_ORIGINS"
                )

    def _accepted(self, name: str) -> bool:
        return name in self._hosts if self._hosts else bool(name) and is_loopback(name)


def host_name(host: str) -> str:
    """Return a header ``Host`` without its port, and without the brackets of an address."""
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0]


def _place_of(origin: str) -> str:
    """Return the host and port of an origin, or an empty text."""
    try:
        return urlsplit(origin).netloc.lower()
    except ValueError:
        return ""
