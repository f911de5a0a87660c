"""A plan in the form that its reader asks for: the header ``Accept`` picks one of the formats."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from typing import Any

from fastapi import Request, Response
from fastapi.responses import StreamingResponse
from werkzeug.datastructures import MIMEAccept
from werkzeug.http import parse_accept_header

from ikplan.errors import InvalidRequest
from ikplan.export import FORMATS
from ikplan.export.formats import Format
from ikplan.result import Plan
from ikplan_api.problems import Refusal

__all__ = ["accepted_format", "document_answer", "plan_answer", "plan_contents"]

_JSON = FORMATS[0]
_PIECE = 256 * 2**10
"""Bytes sent, and compressed, before others get their turn."""


def accepted_format(request: Request) -> Format:
    """Return the format of plans that a request asks for; JSON where it does not matter.

    Raises:
        Refusal: 406, none that there is; they are named.
    """
    header = ",".join(request.headers.getlist("accept"))
    if not header.strip():
        return _JSON
    known = {known.media_type: known for known in FORMATS}
    asked = parse_accept_header(header, MIMEAccept)
    # Parameters, such as a charset, make no difference to any form.
    plain = MIMEAccept([(name.partition(";")[0].strip(), quality) for name, quality in asked])
    best = plain.best_match(known)
    if best is None:
        raise _not_acceptable(f"a plan is not to be had as {header[:200]!r}")
    return known[best]


def _not_acceptable(why: str) -> Refusal:
    names = [known.media_type for known in FORMATS]
    return Refusal(
        InvalidRequest(
            f"the header Accept: {why}; a plan can be {', '.join(names)}",
            field="",
            allowed=names,
        ),
        status=406,
    )


async def plan_answer(
    request: Request, document: bytes, form: Format, headers: Mapping[str, str] | None = None
) -> Response:
    """Answer a plan.

    Args:
        request: What is answered.
        document: The plan as JSON.
        form: The form to answer it in.
        headers: Headers of the answer.

    Raises:
        Refusal: 406, the form cannot hold this plan.
    """
    made = dict(headers or {}, vary="Accept")
    if form is not _JSON:
        try:
            document = await asyncio.to_thread(lambda: form.encode(Plan.load(document)))
        except InvalidRequest as error:
            raise _not_acceptable(error.detail) from error
    return document_answer(request, document, form.media_type, made)


def document_answer(
    request: Request, document: bytes, media_type: str, headers: Mapping[str, str] | None = None
) -> Response:
    """Answer a document; a long one in pieces, so that nobody waits while it is compressed."""
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
    """Document the forms of a plan beside JSON."""
    described: dict[str, Any] = {}
    for form in FORMATS[1:]:
        schema: dict[str, Any] = {"type": "string", "description": form.title}
        if form.media_type.endswith("json"):
            schema = {"type": "object", "description": form.title}
        elif not form.media_type.startswith("text/"):
            schema["format"] = "binary"
        described[form.media_type] = {"schema": schema}
    return described
