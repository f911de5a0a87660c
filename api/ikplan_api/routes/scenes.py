"""Uploaded scenes."""

from __future__ import annotations

import logging
from typing import Any

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.documents.scene import SceneUpload
from ikplan_api.http.openapi import WORKER_ERRORS, problems, request_body
from ikplan_api.http.owner import owner_of
from ikplan_api.http.schemas import StoredScene
from ikplan_api.scenes.uploads import read_scene_upload, stored_scene
from ikplan_api.store.document_store import DocumentStore
from ikplan_api.store.plan_store import StoreFault

__all__ = ["router"]

router = APIRouter(prefix="/v1/scenes", tags=["scenes"])

_log = logging.getLogger("ikplan.service")

_JSON = "application/json"
_TABLE = {"type": "box", "size": [1.0, 0.8, 0.05]}
_EXAMPLE = {
    "name": "cell 3",
    "obstacles": [{"name": "table", "shape": _TABLE, "position": [0.6, 0.0, -0.03]}],
    "clearance": 0.005,
}
_NOT_STORED: dict[int | str, dict[str, Any]] = {
    404: {**problems(errors.InvalidRequest)[errors.InvalidRequest.status]}
    | {"description": "No such scene"}
}


@router.post(
    "",
    summary="Upload a scene",
    response_model=StoredScene,
    status_code=201,
    responses={
        200: {"model": StoredScene, "description": "The scene is already stored"},
        **problems(errors.InvalidRequest, *WORKER_ERRORS),
    },
    openapi_extra=request_body(SceneUpload, _EXAMPLE),
)
async def upload_scene(request: Request) -> Response:
    """Store a scene: obstacles, clearance, allowed pairs, attached bodies, optionally a name.

    The ``id`` in the response is for the field ``scene`` of any request: a hash of the scene, so
    the same scene has the same id. A plan's id is that of the request with the scene itself.
    """
    scene_id, scene = await read_scene_upload(request)
    store: DocumentStore = request.app.state.scenes
    try:
        new = await store.put(scene_id, scene, owner_of(request))
    except StoreFault as error:
        _log.error("failed to store a scene: %s", error)
        raise errors.ServiceUnavailable(
            "scenes cannot be stored now; try again later",
            status_code=errors.ServiceUnavailable.status,
            retry_after_s=60.0,
        ) from error
    return Response(
        scene.info,
        status_code=201 if new else 200,
        media_type=_JSON,
        headers={"location": f"{router.prefix}/{scene_id}"},
    )


@router.get(
    "/{scene_id}",
    summary="Return an uploaded scene",
    response_model=StoredScene,
    responses={**problems(), **_NOT_STORED},
)
async def get_scene(request: Request, scene_id: str) -> Response:
    """Return an uploaded scene with its id and name."""
    return Response((await stored_scene(request, scene_id)).info, media_type=_JSON)


@router.delete(
    "/{scene_id}",
    summary="Delete an uploaded scene",
    status_code=204,
    response_class=Response,
    responses={**problems(), **_NOT_STORED},
)
async def delete_scene(request: Request, scene_id: str) -> Response:
    """Delete an uploaded scene, but neither its plans nor its accepted jobs."""
    await stored_scene(request, scene_id)
    store: DocumentStore = request.app.state.scenes
    await store.delete(scene_id, owner_of(request))
    return Response(status_code=204)
