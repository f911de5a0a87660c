"""Bounded reading of request bodies."""

from __future__ import annotations

from collections.abc import Sequence
from email.message import Message

from fastapi import Request
from starlette.requests import ClientDisconnect

from ikplan.documents.json_text import shortened
from ikplan.errors import InvalidRequest
from ikplan_api.http.disconnect import ClientGone
from ikplan_api.http.problems import Refusal

__all__ = ["media_type_of", "read_body", "read_json_body", "too_long"]

_JSON = "application/json"


async def read_json_body(request: Request) -> bytes:
    """Return the raw body of a JSON request, up to the configured length.

    Raises:
        Refusal: 415, the content type is not JSON; 413, the body is too long.
    """
    return await read_body(request, [_JSON], request.app.state.settings.max_body_bytes)


def media_type_of(request: Request) -> str:
    """Return the media type of a request's body, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def read_body(request: Request, accepted: Sequence[str], limit: int) -> bytes:
    """Return the raw body of a request.

    Args:
        request: The request.
        accepted: Accepted media types.
        limit: Longest body [bytes].

    Raises:
        ClientGone: The client disconnected, or sent too slowly.
        Refusal: 415, another media type, a content encoding or a charset other than UTF-8; 413,
            the body is too long. It is raised as soon as the limit is exceeded, not after the
            whole body.
    """
    _refuse_encodings(request)
    media_type = media_type_of(request)
    if media_type not in accepted:
        # This also forces browsers to send a preflight request for posts from other origins.
        got = f"not {shortened(media_type)!r}" if media_type else "but it is missing"
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
        raise too_long(limit)
    body = bytearray()
    try:
        async for chunk in request.stream():
            body += chunk
            if len(body) > limit:
                raise too_long(limit)
    except ClientDisconnect as error:
        raise ClientGone from error
    return bytes(body)


def _refuse_encodings(request: Request) -> None:
    """Refuse a body that is compressed or in another charset: read as text, it is another one.

    Raises:
        Refusal: 415, with the field of the header.
    """
    codings = [
        coding.strip().lower()
        for value in request.headers.getlist("content-encoding")
        for coding in value.split(",")
    ]
    if any(coding not in ("", "identity") for coding in codings):
        got = ", ".join(codings)
        raise Refusal(
            InvalidRequest(
                f"the header Content-Encoding is {shortened(got)!r}; send the body uncompressed",
                field="",
                allowed="identity",
            ),
            status=415,
            headers={"accept-encoding": "identity"},
        )
    content_type = request.headers.get("content-type", "")
    if ";" not in content_type:  # it has no parameters
        return
    charset = Message()
    charset["content-type"] = content_type
    named = charset.get_content_charset("utf-8")
    if named not in ("utf-8", "utf8", "us-ascii"):
        raise Refusal(
            InvalidRequest(
                f"the charset of the header Content-Type is {shortened(named)!r}; send UTF-8",
                field="",
                allowed="utf-8",
            ),
            status=415,
        )


def too_long(limit: int) -> Refusal:
    """Return the refusal of a request that is longer than a limit [bytes]."""
    return Refusal(
        InvalidRequest(
            f"the request is longer than {limit} bytes",
            field="",
            allowed=f"at most {limit} bytes",
        ),
        status=413,
    )
