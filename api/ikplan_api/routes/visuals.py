"""Robot geometry for display: a visual URDF and its meshes."""

from __future__ import annotations

import asyncio
import hashlib
from pathlib import Path

from fastapi import APIRouter, HTTPException, Request, Response
from starlette_compress import add_compress_type

from ikplan import errors
from ikplan.robots import RobotVisual, catalogue_visual, is_upload_id
from ikplan_api.http.disconnect import while_connected
from ikplan_api.http.files import file_response
from ikplan_api.http.openapi import WORKER_ERRORS, problems
from ikplan_api.robots.uploads import stored_robot
from ikplan_api.workers.headed import split_head
from ikplan_api.workers.planner import Planner

__all__ = ["router"]

router = APIRouter(prefix="/v1/robots", tags=["robots and solvers"])

_URDF = {"application/xml": {"schema": {"type": "string"}}}
_MEDIA = {".dae": "model/vnd.collada+xml", ".obj": "model/obj", ".stl": "model/stl"}
_A_WEEK = "private, max-age=604800"
for _media_type in _MEDIA.values():
    add_compress_type(_media_type)  # text or plain numbers: a fraction of the bytes


@router.get(
    "/{name}/visual",
    summary="Get the visual geometry of a robot",
    response_class=Response,
    responses={
        **problems(errors.RobotNotFound, errors.InvalidRobot, *WORKER_ERRORS),
        200: {"description": "A URDF", "content": _URDF},
    },
)
async def get_robot_visual(request: Request, name: str) -> Response:
    """Return a URDF of the robot's links, joints and visual geometry.

    Its mesh URLs point to this service. A robot without geometry has links and joints only.
    """
    visual = await _visual(request, name)
    document = visual.urdf.encode()
    tag = f'"{hashlib.sha256(document).hexdigest()[:32]}"'
    headers = {"etag": tag, "cache-control": "private, no-cache"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    return Response(document, media_type="application/xml", headers=headers)


@router.get("/{name}/meshes/{path:path}", include_in_schema=False)
async def get_robot_mesh(request: Request, name: str, path: str) -> Response:
    """Return a mesh of the robot's visual URDF; other files are not accessible."""
    visual = await _visual(request, name)
    # The path is looked up among the known meshes and never joined to a folder.
    file = visual.meshes.get(path)
    if file is None:
        raise HTTPException(404)
    return file_response(request, file, _MEDIA[file.suffix.lower()], _A_WEEK)


async def _visual(request: Request, name: str) -> RobotVisual:
    prefix = f"{request.scope.get('root_path', '')}{router.prefix}/{name}/meshes/"
    if not is_upload_id(name):
        return await asyncio.to_thread(catalogue_visual, name, prefix.__add__)
    document = (await stored_robot(request, name)).document
    planner: Planner = request.app.state.planner
    work = planner.run("draw-robot", prefix.encode(), robot=document)
    meshes, urdf = split_head((await while_connected(request, work)).document)
    return RobotVisual(urdf.decode(), {path: Path(file) for path, file in meshes.items()}, ())
