"""Who may ask: bearers of a key, or this machine alone where there are no keys."""

from __future__ import annotations

import hmac
import ipaddress
import time
from collections.abc import Sequence

import limits
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter
from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from ikplan.api_keys import key_hash
from ikplan.errors import AccessDenied, IkplanError, RateLimited
from ikplan_api.access_settings import ApiKey, is_loopback
from ikplan_api.problems import error_response

__all__ = ["AccessMiddleware"]

_OPEN = frozenset({"/", "/docs", "/openapi.json", "/livez", "/readyz", "/version"})
_OPEN_FOLDER = "/page/"
"""What probes and browsers ask before they can have a key: nothing about plans or robots."""


class AccessMiddleware:
    """Lets through who has a key, as often as the key may ask.

    Without keys, only connections to a loopback address are answered, however the service was
    started.

    Args:
        app: The application behind.
        keys: The keys known here.
        rate_limit: Requests of each key, such as ``1200/minute``; empty: no limit.
    """

    def __init__(self, app: ASGIApp, *, keys: Sequence[ApiKey], rate_limit: str) -> None:
        self._app = app
        self._keys = tuple(keys)
        self._rate = limits.parse(rate_limit) if rate_limit and keys else None
        self._limiter = MovingWindowRateLimiter(MemoryStorage())

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or refuse it."""
        if scope["type"] == "http":
            try:
                self._check(scope)
            except IkplanError as error:
                status = 403 if isinstance(error, AccessDenied) and not self._keys else None
                answer = error_response(Request(scope), error, status)
                await answer(scope, receive, send)
                return
        await self._app(scope, receive, send)

    def _check(self, scope: Scope) -> None:
        """Raise what keeps a request out.

        Raises:
            AccessDenied: No key, or one that is not known here.
            RateLimited: The key asked too often.
        """
        path = str(scope["path"])
        if path in _OPEN or path.startswith(_OPEN_FOLDER):
            return
        if not self._keys:
            if _reached_from_outside(scope):
                raise AccessDenied(
                    "this service has no keys, so it answers on loopback addresses only; its "
                    "operator makes a key with `ikplan keys new`"
                )
            return
        name = self._bearer(Headers(scope=scope).getlist("authorization"))
        scope.setdefault("state", {})["key"] = name
        if self._rate is not None and not self._limiter.hit(self._rate, name):
            reset = self._limiter.get_window_stats(self._rate, name).reset_time
            raise RateLimited(limit=str(self._rate), retry_after_s=_seconds_until(reset))

    def _bearer(self, authorization: Sequence[str]) -> str:
        """Name of the key that a request carries."""
        scheme, _, key = (authorization[0] if len(authorization) == 1 else "").partition(" ")
        if scheme.lower() != "bearer" or not key.strip():
            raise AccessDenied("a key is needed here: the header `Authorization: Bearer <key>`")
        asked, name = key_hash(key.strip()), ""
        for known in self._keys:  # all of them, whichever it is, so that time tells nothing
            if hmac.compare_digest(known.hash, asked):
                name = known.name
        if not name:
            raise AccessDenied("this key is not known here")
        return name


def _seconds_until(moment: float) -> float:
    return round(max(0.0, moment - time.time()), 3)


def _reached_from_outside(scope: Scope) -> bool:
    """Whether the connection came in by an address that is not this machine's own."""
    host = str((scope.get("server") or [""])[0])
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False  # a socket in the file system, or a transport without any
    return not is_loopback(host)
