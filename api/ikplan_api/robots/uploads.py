"""Uploaded robots: reading an upload, and finding the robot that a request names."""

from __future__ import annotations

import asyncio
import re

import pydantic_core
from fastapi import Request

from ikplan.documents import parse, parse_json
from ikplan.errors import IkplanError, InvalidRequest, InvalidRobot, RobotNotFound
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan.robots import RobotUpload, is_upload_id, robot_names
from ikplan_api.http.body import media_type_of, read_body
from ikplan_api.http.owner import owner_of
from ikplan_api.http.problems import Refusal
from ikplan_api.store.document_store import DocumentStore, StoredDocument
from ikplan_api.workers.tasks import SHORT, parse_request

__all__ = ["JSON", "QUERY", "XML", "named_robot", "read_upload", "robot_document", "stored_robot"]

JSON = "application/json"
XML = ("application/xml", "text/xml", "application/urdf+xml")
QUERY = ("base", "tip", "title")
"""Query parameters of an upload in XML."""

_NAMED = re.compile(rb'"robot"\s*:\s*"(urdf-[0-9a-f]{1,64})"')
_ENVELOPE = 64 * 2**10
"""Bytes of an upload in JSON besides its URDF and SRDF."""


async def read_upload(request: Request) -> RobotUpload:
    """Return the upload in a request: JSON, or a URDF in XML.

    Raises:
        InvalidRequest: A field is invalid.
        InvalidRobot: The URDF is not text.
        Refusal: 413, too long; 415, neither JSON nor XML.
    """
    limit: int = request.app.state.settings.max_urdf_bytes
    fields = dict(request.query_params)
    if media_type_of(request) == JSON:
        # Two documents; JSON takes two bytes for a quote and, escaped, up to three times the
        # bytes of UTF-8 for letters beyond ASCII.
        body = await read_body(request, [JSON, *XML], 6 * limit + _ENVELOPE)
        if fields:
            raise InvalidRequest(
                f"{next(iter(fields))}: in a JSON upload, put this into the document",
                field=next(iter(fields)),
            )
        upload = await asyncio.to_thread(parse_json, RobotUpload, body)
    else:
        body = await read_body(request, [JSON, *XML], limit)
        try:
            urdf = body.decode()
        except UnicodeDecodeError as error:
            raise InvalidRobot(f"the URDF is not UTF-8 text: {error.reason}") from error
        unknown = next((name for name in fields if name not in QUERY), None)
        if unknown is not None:
            raise InvalidRequest(
                f"{unknown}: unknown field; known fields: {', '.join(QUERY)}; "
                "for other fields, upload JSON",
                field=unknown,
                allowed=list(QUERY),
            )
        upload = parse(RobotUpload, {"urdf": urdf, **fields})
    for name, text in (("urdf", upload.urdf), ("srdf", upload.srdf or "")):
        if len(text.encode(errors="replace")) > limit:
            message = f"{name}: longer than {limit} bytes"
            raise Refusal(
                InvalidRequest(message, field=name, allowed=f"at most {limit} bytes"), status=413
            )
    return upload


async def stored_robot(request: Request, name: str) -> StoredDocument:
    """Return an uploaded robot.

    Raises:
        RobotNotFound: It is not or no longer stored.
    """
    store: DocumentStore = request.app.state.robots
    robot = await store.get(name, owner_of(request))
    if robot is None:
        raise RobotNotFound(
            f"no robot {name!r} is stored here; upload it again", name=name, valid=robot_names()
        )
    return robot


async def robot_document(request: Request, body: bytes) -> bytes | None:
    """Return the uploaded robot that a request document names, or None.

    Args:
        request: The request.
        body: Its document, which may be invalid: the worker reports that.

    Raises:
        RobotNotFound: The named robot is not stored here.
    """
    if b"urdf-" not in body:
        return None
    if len(body) > SHORT:
        # Parsing would block the event loop. Where the text is of another field, the worker does
        # not use the robot.
        found = _NAMED.search(body)
        return None if found is None else (await stored_robot(request, found[1].decode())).document
    try:
        content = pydantic_core.from_json(body)
    except ValueError:
        return None
    name = content.get("robot") if isinstance(content, dict) else None
    if not isinstance(name, str) or not is_upload_id(name):
        return None
    return (await stored_robot(request, name)).document


async def named_robot(
    request: Request, kind: str, document: bytes
) -> tuple[bytes | None, KnownRequest]:
    """Return the uploaded robot that a request for a plan names, and what is known of it then.

    Args:
        request: The HTTP request.
        kind: ``"plan"`` or ``"time"``.
        document: The request for a plan, which may be invalid: who identifies it reports that.

    Raises:
        RobotNotFound: The named robot is not stored here.
    """
    if b"urdf-" not in document:
        return None, UNKNOWN
    if len(document) > SHORT:
        return await robot_document(request, document), UNKNOWN
    try:
        parsed = parse_request(kind, document)
    except IkplanError:
        return None, UNKNOWN
    name = parsed.robot
    robot = (await stored_robot(request, name)).document if is_upload_id(name) else None
    return robot, KnownRequest(parsed)
