"""Access log and metrics of every request."""

from __future__ import annotations

import logging
import time
from collections.abc import MutableMapping
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ikplan_api.telemetry.metrics import Metrics

__all__ = ["AccessLogMiddleware", "is_probe"]

_log = logging.getLogger("ikplan.access")

_METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
_PROBES = frozenset({"/livez", "/readyz", "/metrics"})


def is_probe(scope: MutableMapping[str, Any]) -> bool:
    """Whether a request is a periodic probe of a monitoring system."""
    return scope.get("path") in _PROBES


class AccessLogMiddleware:
    """Logs every request with its status and duration, and counts it in the metrics.

    Args:
        app: The wrapped application.
        metrics: The metrics to update.
    """

    def __init__(self, app: ASGIApp, *, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        began, status, sent = time.perf_counter(), 500, 0

        async def observed(message: Message) -> None:
            nonlocal status, sent
            if message["type"] == "http.response.start":
                status = message["status"]
            sent += len(message.get("body", b""))
            await send(message)

        self._metrics.in_flight.inc()
        try:
            await self._app(scope, receive, observed)
        finally:
            self._metrics.in_flight.dec()
            self._record(scope, status, sent, time.perf_counter() - began)

    def _record(self, scope: Scope, status: int, sent: int, seconds: float) -> None:
        method = scope["method"] if scope["method"] in _METHODS else "other"
        # The declared path, not the requested one, so that clients cannot create label values.
        route = getattr(scope.get("route"), "path", "none")
        self._metrics.requests.labels(method, route, str(status)).observe(seconds)
        state: dict[str, Any] = scope.get("state", {})
        _log.log(
            logging.DEBUG if is_probe(scope) else logging.INFO,
            "%s %s %d",
            method,
            ascii(scope["path"])[1:-1],
            status,
            extra={
                "method": method,
                "path": scope["path"],
                "route": route,
                "status": status,
                "bytes": sent,
                "seconds": round(seconds, 6),
                "client": (scope.get("client") or ("",))[0],
                "key": state.get("key"),
                "problem": state.get("problem"),
            },
        )
