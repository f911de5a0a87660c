"""What stands around the application, from the outside in."""

from __future__ import annotations

from fastapi import FastAPI
from starlette.middleware.cors import CORSMiddleware
from starlette_compress import CompressMiddleware

from ikplan_api.access import AccessMiddleware
from ikplan_api.metrics import Metrics
from ikplan_api.middleware import RequestIdMiddleware
from ikplan_api.observing import ObserveMiddleware
from ikplan_api.security_headers import SecurityHeadersMiddleware
from ikplan_api.settings import Settings

__all__ = ["COMPRESSED_FROM", "wrap"]

COMPRESSED_FROM = 1024
"""Shortest answer that is compressed [bytes]."""


def wrap(app: FastAPI, settings: Settings, metrics: Metrics) -> None:
    """Put the middleware around an app; the last one added is the outermost."""
    # The fastest levels: a plan's digits hardly get shorter at others, and the event loop waits.
    app.add_middleware(
        CompressMiddleware,
        minimum_size=COMPRESSED_FROM,
        zstd_level=1,
        gzip_level=1,
        brotli=False,
    )
    app.add_middleware(AccessMiddleware, keys=settings.api_keys, rate_limit=settings.rate_limit)
    if settings.cors_origins:
        # Outside of the keys: a browser asks for leave without one.
        app.add_middleware(
            CORSMiddleware,
            allow_origins=settings.cors_origins,
            allow_methods=["GET", "POST", "DELETE"],
            allow_headers=["accept", "authorization", "content-type", "prefer", "if-none-match"],
            expose_headers=["content-location", "etag", "location", "retry-after", "x-request-id"],
        )
    app.add_middleware(SecurityHeadersMiddleware)
    app.add_middleware(ObserveMiddleware, metrics=metrics)
    app.add_middleware(RequestIdMiddleware)
