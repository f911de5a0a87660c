"""Access control: API keys with rate limits, or loopback connections if there are no keys."""

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

from ikplan.client.api_keys import key_hash
from ikplan.errors import AccessDenied, IkplanError, RateLimited
from ikplan_api.http.problems import Refusal, error_response
from ikplan_api.settings.access import ApiKey, Role, is_loopback

__all__ = ["AccessMiddleware"]

_PUBLIC = frozenset({"/", "/docs", "/openapi.json", "/problems", "/livez", "/readyz", "/version"})
_AUDIT = "/v1/audit"
_OPEN_FOLDERS = ("/page/", "/docs/", "/problems/")
"""Public paths, for probes and browsers without a key: they reveal no plans and no robots."""


class AccessMiddleware:
    """Accepts requests with a valid API key, up to a rate limit for each key.

    Without configured keys, it accepts connections to a loopback address only.

    Args:
        app: The wrapped application.
        keys: The configured keys.
        rate_limit: Limit for each key, such as ``1200/minute``; empty: no limit.
    """

    def __init__(self, app: ASGIApp, *, keys: Sequence[ApiKey], rate_limit: str) -> None:
        self._app = app
        self._keys = tuple(keys)
        self._rate = limits.parse(rate_limit) if rate_limit and keys else None
        self._limiter = MovingWindowRateLimiter(MemoryStorage())

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection, or refuse it."""
        if scope["type"] == "http":
            try:
                self._check(scope)
            except Refusal as refusal:
                answer = error_response(Request(scope), refusal.error, refusal.status)
                await answer(scope, receive, send)
                return
            except IkplanError as error:
                status = 403 if isinstance(error, AccessDenied) and not self._keys else None
                answer = error_response(Request(scope), error, status)
                await answer(scope, receive, send)
                return
        await self._app(scope, receive, send)

    def _check(self, scope: Scope) -> None:
        """Check the key and the rate limit of a request.

        Raises:
            AccessDenied: The key is missing or invalid.
            RateLimited: The key exceeded its rate limit.
            Refusal: 403, the role of the key does not allow it.
        """
        path = str(scope["path"])
        if path in _PUBLIC or path.startswith(_OPEN_FOLDERS):
            return
        if not self._keys:
            if _reached_from_outside(scope):
                raise AccessDenied(
                    "this service has no API keys and accepts loopback connections only; its "
                    "operator can create a key with `ikplan keys new`"
                )
            return
        key = self._bearer(Headers(scope=scope).getlist("authorization"))
        scope.setdefault("state", {})["key"] = key.name
        rate = limits.parse(key.rate) if key.rate is not None else self._rate
        if rate is not None and not self._limiter.hit(rate, key.name):
            reset = self._limiter.get_window_stats(rate, key.name).reset_time
            raise RateLimited(limit=str(rate), retry_after_s=_seconds_until(reset))
        if not _may(key.role, str(scope["method"]), path):
            raise Refusal(
                AccessDenied(f"a key with the role {key.role} may not do this"), status=403
            )

    def _bearer(self, authorization: Sequence[str]) -> ApiKey:
        """Return a request's key."""
        scheme, _, key = (authorization[0] if len(authorization) == 1 else "").partition(" ")
        if scheme.lower() != "bearer" or not key.strip():
            raise AccessDenied(
                "an API key is required: send the header `Authorization: Bearer <key>`"
            )
        digest, found = key_hash(key.strip()), None
        for known in self._keys:  # compare with every key, so that timing reveals nothing
            if hmac.compare_digest(known.hash, digest):
                found = known
        if found is None:
            raise AccessDenied("invalid API key")
        return found


def _may(role: Role, method: str, path: str) -> bool:
    """Whether a key may do something with what is its own."""
    if role == "monitor":
        return path == "/metrics"
    if path == _AUDIT:
        return role == "auditor"
    return role == "planner" or method in ("GET", "HEAD", "OPTIONS")


def _seconds_until(moment: float) -> float:
    return round(max(0.0, moment - time.time()), 3)


def _reached_from_outside(scope: Scope) -> bool:
    """Whether the connection arrived at a non-loopback address."""
    host = str((scope.get("server") or [""])[0])
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False  # a Unix socket, or a transport without addresses
    return not is_loopback(host)
