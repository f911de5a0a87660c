"""Plans in the format that the header ``Accept`` selects."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from typing import Any

from fastapi import Request, Response
from fastapi.responses import StreamingResponse
from werkzeug.datastructures import MIMEAccept
from werkzeug.http import parse_accept_header

from ikplan.errors import InvalidRequest
from ikplan.plans.export import FORMATS
from ikplan.plans.export.formats import Format
from ikplan_api.http.problems import Refusal

__all__ = ["accepted_format", "document_response", "not_acceptable", "plan_contents"]

_JSON = FORMATS[0]
_PIECE = 256 * 2**10
"""Bytes compressed and sent before the event loop serves other requests."""


def accepted_format(request: Request) -> Format:
    """Return the plan format that a request accepts; JSON if it accepts any.

    Raises:
        Refusal: 406, no available format is acceptable; it lists the available ones.
    """
    header = ",".join(request.headers.getlist("accept"))
    if not header.strip():
        return _JSON
    known = {known.media_type: known for known in FORMATS}
    asked = parse_accept_header(header, MIMEAccept)
    # No format has parameters such as a charset.
    plain = MIMEAccept([(name.partition(";")[0].strip(), quality) for name, quality in asked])
    best = plain.best_match(known)
    if best is None:
        raise not_acceptable(f"plans are not available as {header[:200]!r}")
    return known[best]


def not_acceptable(why: str) -> Refusal:
    """Return the refusal 406 with the available formats."""
    names = [known.media_type for known in FORMATS]
    return Refusal(
        InvalidRequest(
            f"the header Accept: {why}; available formats: {', '.join(names)}",
            field="",
            allowed=names,
        ),
        status=406,
    )


def document_response(
    request: Request, document: bytes, media_type: str, headers: Mapping[str, str] | None = None
) -> Response:
    """Return a response with a document; long ones in pieces, to compress without blocking."""
    encodings = request.headers.get("accept-encoding", "").strip()
    if len(document) <= _PIECE or encodings in ("", "identity"):
        return Response(document, media_type=media_type, headers=dict(headers or {}))
    return StreamingResponse(
        _pieces(document),
        media_type=media_type,
        headers={**(headers or {}), "content-length": str(len(document))},
    )


async def _pieces(document: bytes) -> AsyncIterator[bytes]:
    for start in range(0, len(document), _PIECE):
        yield document[start : start + _PIECE]
        await asyncio.sleep(0)


def plan_contents() -> dict[str, Any]:
    """Return the OpenAPI content of every plan format except JSON."""
    described: dict[str, Any] = {}
    for form in FORMATS[1:]:
        schema: dict[str, Any] = {"type": "string", "description": form.title}
        if form.media_type.endswith("json"):
            schema = {"type": "object", "description": form.title}
        elif not form.media_type.startswith("text/"):
            schema["format"] = "binary"
        described[form.media_type] = {"schema": schema}
    return described
