"""Reading a request body, before anything believes it."""

from __future__ import annotations

from collections.abc import Sequence

from fastapi import Request

from ikplan.errors import InvalidRequest
from ikplan_api.problems import Refusal

__all__ = ["media_type_of", "read_body", "read_json_body"]

_JSON = "application/json"


async def read_json_body(request: Request) -> bytes:
    """Return the body of a request that says it is JSON, as it came, at most so long.

    Raises:
        Refusal: 415, not JSON; 413, too long, told as soon as it is known.
    """
    return await read_body(request, [_JSON], request.app.state.settings.max_body_bytes)


def media_type_of(request: Request) -> str:
    """Return what a request says its body is, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def read_body(request: Request, accepted: Sequence[str], limit: int) -> bytes:
    """Return the body of a request, as it came.

    Args:
        request: The request.
        accepted: Media types that it may say it is.
        limit: Longest body [bytes].

    Raises:
        Refusal: 415, of another type; 413, too long, told as soon as it is known.
    """
    media_type = media_type_of(request)
    if media_type not in accepted:
        # Also what keeps a foreign web page from posting here without asking the browser.
        got = f"not {media_type!r}" if media_type else "and there is none"
        raise Refusal(
            InvalidRequest(
                f"the header Content-Type must be {' or '.join(accepted)}, {got}",
                field="",
                allowed=accepted[0] if len(accepted) == 1 else list(accepted),
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
