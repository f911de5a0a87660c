"""Reading a request body, before anything believes it."""

from __future__ import annotations

from fastapi import Request

from ikplan.errors import InvalidRequest
from ikplan_api.problems import Refusal

__all__ = ["read_json_body"]


async def read_json_body(request: Request) -> bytes:
    """Return the body of a request that says it is JSON, as it came, at most so long.

    Raises:
        Refusal: 415, not JSON; 413, too long, told as soon as it is known.
    """
    limit: int = request.app.state.settings.max_body_bytes
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type != "application/json":
        # Also what keeps a foreign web page from posting here without asking the browser.
        got = f"not {media_type!r}" if media_type else "and there is none"
        raise Refusal(
            InvalidRequest(
                f"the header Content-Type must be application/json, {got}",
                field="",
                allowed="application/json",
            ),
            status=415,
        )
    announced = request.headers.get("content-length", "")
    if announced.isdecimal() and int(announced[:20]) > limit:
        raise _too_long(limit)
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit:
            raise _too_long(limit)
    return bytes(body)


def _too_long(limit: int) -> Refusal:
    return Refusal(
        InvalidRequest(
            f"the request is longer than {limit} bytes",
            field="",
            allowed=f"at most {limit} bytes",
        ),
        status=413,
    )
