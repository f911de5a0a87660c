"""Uploaded robots: how they come in, and how a request that names one finds it."""

from __future__ import annotations

import asyncio

import pydantic_core
from fastapi import Request

from ikplan.documents import parse, parse_json
from ikplan.errors import InvalidRequest, InvalidRobot, RobotNotFound
from ikplan.robots import RobotUpload, is_upload_id, robot_names
from ikplan_api.body import media_type_of, read_body
from ikplan_api.problems import Refusal
from ikplan_api.robot_store import RobotStore, StoredRobot

__all__ = ["JSON", "QUERY", "XML", "read_upload", "robot_document", "stored_robot"]

JSON = "application/json"
XML = ("application/xml", "text/xml", "application/urdf+xml")
QUERY = ("base", "tip", "title")
"""Fields that can go with a URDF sent as it is."""

_ENVELOPE = 64 * 2**10
"""Bytes that an upload in JSON may have beside its URDF and SRDF."""


async def read_upload(request: Request) -> RobotUpload:
    """Return the upload that a request carries: JSON, or the URDF as it is.

    Raises:
        InvalidRequest: A field is wrong.
        InvalidRobot: The URDF is not text.
        Refusal: 413, too long; 415, neither JSON nor XML.
    """
    limit: int = request.app.state.settings.max_urdf_bytes
    fields = dict(request.query_params)
    if media_type_of(request) == JSON:
        # Two documents, whose quotes take two bytes in JSON, and letters beyond ASCII three times
        # as many as in UTF-8.
        body = await read_body(request, [JSON, *XML], 6 * limit + _ENVELOPE)
        if fields:
            raise InvalidRequest(
                f"{next(iter(fields))}: in a JSON upload, this belongs into the document",
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
                "for all others, upload JSON",
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


async def stored_robot(request: Request, name: str) -> StoredRobot:
    """Return an uploaded robot.

    Raises:
        RobotNotFound: It is not kept here (any more).
    """
    store: RobotStore = request.app.state.robots
    robot = await store.get(name)
    if robot is None:
        raise RobotNotFound(
            f"no robot {name!r} is kept here; upload it again", name=name, valid=robot_names()
        )
    return robot


async def robot_document(request: Request, body: bytes) -> bytes | None:
    """Return the upload that a request document names, None if it names none.

    Args:
        request: The request.
        body: Its document, which may be wrong in any way: the worker says so.

    Raises:
        RobotNotFound: It names one that is not kept here.
    """
    if b"urdf-" not in body:
        return None
    try:
        content = pydantic_core.from_json(body)
    except ValueError:
        return None
    name = content.get("robot") if isinstance(content, dict) else None
    if not isinstance(name, str) or not is_upload_id(name):
        return None
    return (await stored_robot(request, name)).document
