"""Installation of the middleware in its fixed order."""

from __future__ import annotations

from fastapi import FastAPI
from starlette.middleware.cors import CORSMiddleware
from starlette_compress import CompressMiddleware

from ikplan_api.middleware.access import AccessMiddleware
from ikplan_api.middleware.access_log import AccessLogMiddleware
from ikplan_api.middleware.hosts import HostsMiddleware
from ikplan_api.middleware.request_id import RequestIdMiddleware
from ikplan_api.middleware.security_headers import SecurityHeadersMiddleware
from ikplan_api.settings import Settings
from ikplan_api.telemetry.metrics import Metrics

__all__ = ["COMPRESSED_FROM", "install_middleware"]

COMPRESSED_FROM = 1024
"""Length from which responses are compressed [bytes]."""


def install_middleware(app: FastAPI, settings: Settings, metrics: Metrics) -> None:
    """Add the middleware to an app; the last one added is the outermost."""
    # The fastest levels: higher ones compress the digits of a plan hardly better, and compression
    # blocks the event loop.
    app.add_middleware(
        CompressMiddleware,
        minimum_size=COMPRESSED_FROM,
        zstd_level=1,
        gzip_level=1,
        brotli=False,
    )
    app.add_middleware(AccessMiddleware, keys=settings.api_keys, rate_limit=settings.rate_limit)
    if settings.cors_origins:
        # Outside of access control: a browser's preflight request has no key.
        app.add_middleware(
            CORSMiddleware,
            allow_origins=settings.cors_origins,
            allow_methods=["GET", "POST", "DELETE"],
            allow_headers=["accept", "authorization", "content-type", "prefer", "if-none-match"],
            expose_headers=["content-location", "etag", "location", "retry-after", "x-request-id"],
        )
    if settings.hosts or not settings.api_keys:
        app.add_middleware(HostsMiddleware, hosts=settings.hosts, origins=settings.cors_origins)
    app.add_middleware(AccessLogMiddleware, metrics=metrics)
    app.add_middleware(RequestIdMiddleware)
    app.add_middleware(SecurityHeadersMiddleware)  # outermost: on unexpected failures too
