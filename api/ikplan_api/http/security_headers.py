"""Headers of every answer, for browsers and caches."""

from __future__ import annotations

__all__ = ["SECURITY_HEADERS"]

SECURITY_HEADERS = {
    # Plans, robots and their problems are the caller's: no cache keeps what does not say so.
    "cache-control": "private, no-store",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=()",
    # For responses without a policy of their own: data that loads and runs nothing.
    "content-security-policy": "default-src 'none'; frame-ancestors 'none'",
}
"""Values that an answer has unless it sets its own."""
