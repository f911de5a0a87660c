"""Uploaded scenes: reading an upload, and putting the scene that a request names into it."""

from __future__ import annotations

import asyncio
import json
import re

from fastapi import Request

from ikplan.errors import InvalidRequest
from ikplan_api.http.body import read_json_body
from ikplan_api.http.disconnect import while_connected
from ikplan_api.http.owner import owner_of
from ikplan_api.http.problems import Refusal
from ikplan_api.store.document_store import DocumentStore, StoredDocument
from ikplan_api.workers.headed import split_head
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.scene_file import read_scene_file
from ikplan_api.workers.tasks import SHORT

__all__ = ["read_scene_upload", "stored_scene", "with_stored_scene"]

_NAMED = re.compile(rb'"scene"\s*:\s*"([^"\\]{1,200})"')
"""A scene by its id, in the text of a request: only there is a string the value of ``scene``."""


async def read_scene_upload(request: Request) -> tuple[str, StoredDocument]:
    """Return the scene in a request and its id, a hash of what is in the scene.

    Raises:
        InvalidRequest: A field is invalid, or a mesh is given by a file.
        Refusal: 413, too long; 415, not JSON.
        ServiceUnavailable: The queue is full, and the scene is long.
    """
    body = await read_json_body(request)
    if len(body) <= SHORT:
        message = await asyncio.to_thread(read_scene_file, body)
    else:
        planner: Planner = request.app.state.planner
        message = (await while_connected(request, planner.run("read-scene", body))).document
    head, document = split_head(message)
    info = json.dumps(head).encode()[:-1] + b"," + document[1:]
    return head["id"], StoredDocument(document, info)


async def stored_scene(request: Request, scene_id: str) -> StoredDocument:
    """Return an uploaded scene.

    Raises:
        Refusal: 404, it is not or no longer stored.
    """
    store: DocumentStore = request.app.state.scenes
    scene = await store.get(scene_id, owner_of(request))
    if scene is None:
        raise Refusal(_unknown(scene_id, field="id"), status=404)
    return scene


async def with_stored_scene(request: Request, body: bytes) -> bytes:
    """Return a request document with the scene itself in place of the id of an uploaded one.

    The plan then has the id that it has for the scene itself, and a job that is accepted does not
    depend on what is deleted later.

    Args:
        request: The HTTP request.
        body: Its document, which may be invalid: who reads it reports that.

    Raises:
        InvalidRequest: No scene of that id is stored here.
    """
    found = _NAMED.search(body)
    if found is None:
        return body
    store: DocumentStore = request.app.state.scenes
    scene_id = found[1].decode(errors="replace")
    scene = await store.get(scene_id, owner_of(request))
    if scene is None:
        raise _unknown(scene_id, field="scene")
    return body[: found.start(1) - 1] + scene.document + body[found.end(1) + 1 :]


def _unknown(scene_id: str, field: str) -> InvalidRequest:
    return InvalidRequest(
        f"{field}: no scene {scene_id!r} is stored here; upload it by POST /v1/scenes, which "
        "returns its id, or put the scene itself into the request",
        field=field,
        allowed="the id of an uploaded scene",
    )
