"""Robots, including uploaded ones, and solvers."""

from __future__ import annotations

import asyncio
import json
import logging

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.robots import RobotInfo, RobotUpload, catalogue_robot, is_upload_id
from ikplan_api.http.disconnect import while_connected
from ikplan_api.http.openapi import WORKER_ERRORS, problems, upload_body
from ikplan_api.http.owner import owner_of
from ikplan_api.http.problems import Refusal
from ikplan_api.http.schemas import RobotList, SolverList
from ikplan_api.robots.robot_builder import RobotBuilder
from ikplan_api.robots.uploads import QUERY, XML, read_upload, stored_robot
from ikplan_api.store.document_store import DocumentStore, StoredDocument
from ikplan_api.store.plan_store import StoreFault
from ikplan_api.workers import tasks
from ikplan_api.workers.planner import Planner

__all__ = ["router"]

router = APIRouter(prefix="/v1", tags=["robots and solvers"])

_log = logging.getLogger("ikplan.service")

_JSON = "application/json"
_SHORT = 32 * 1024
"""Longest upload that this process checks, within some milliseconds [bytes]."""
_URDF = (
    '<robot name="two"><link name="base"/><link name="arm"/><link name="tool"/>'
    '<joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>'
    '<axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="2" effort="0"/></joint>'
    '<joint name="elbow" type="revolute"><origin xyz="0.4 0 0"/><parent link="arm"/>'
    '<child link="tool"/><axis xyz="0 1 0"/>'
    '<limit lower="-2" upper="2" velocity="2" effort="0"/></joint></robot>'
)
_EXAMPLE = {"urdf": _URDF, "title": "Two joints", "tool": {"position": [0.3, 0.0, 0.0]}}


@router.get("/robots", summary="List the robots", response_model=RobotList, responses=problems())
async def list_robots(request: Request) -> Response:
    """Return every robot with its joints, limits, home, frames and sources; uploads last."""
    document = await asyncio.to_thread(tasks.robots_document)
    store: DocumentStore = request.app.state.robots
    owner = owner_of(request)
    stored = [await store.get(name, owner) for name in await store.names(owner)]
    uploads = [robot.info for robot in stored if robot is not None]
    if uploads:
        document = document.removesuffix(b"]}") + b"," + b",".join(uploads) + b"]}"
    return Response(document, media_type=_JSON)


@router.post(
    "/robots",
    summary="Upload a robot",
    response_model=RobotInfo,
    status_code=201,
    responses={
        200: {"model": RobotInfo, "description": "The robot is already stored"},
        **problems(errors.InvalidRequest, errors.InvalidRobot, *WORKER_ERRORS),
    },
    openapi_extra=upload_body(RobotUpload, _EXAMPLE, XML, QUERY),
)
async def upload_robot(request: Request) -> Response:
    """Upload a URDF, as XML or in a JSON document with an SRDF, limits, home and tool.

    The ``name`` in the response is the robot's id, for the field ``robot`` of any request: a hash
    of the upload, so the same upload has the same name. Meshes are never opened.
    """
    upload = await read_upload(request)
    # Checked here first; only valid uploads reach Pinocchio, in a process of its own.
    name, document = upload.content_id(), upload.canonical()
    if len(document) <= _SHORT:
        await asyncio.to_thread(upload.describe)
    else:
        planner: Planner = request.app.state.planner
        await while_connected(request, planner.run("check-upload", document))
    builder: RobotBuilder = request.app.state.robot_builder
    store: DocumentStore = request.app.state.robots
    owner = owner_of(request)
    known = await store.get(name, owner)
    if known is None:
        info = await builder.build(document, name=name)
        known = StoredDocument(document, json.dumps(info, allow_nan=False).encode())
    try:
        new = await store.put(name, known, owner)
    except StoreFault as error:
        _log.error("failed to store a robot: %s", error)
        raise errors.ServiceUnavailable(
            "robots cannot be stored now; try again later",
            status_code=errors.ServiceUnavailable.status,
            retry_after_s=60.0,
        ) from error
    return Response(
        known.info,
        status_code=201 if new else 200,
        media_type=_JSON,
        headers={"location": f"{router.prefix}/robots/{name}"},
    )


@router.get(
    "/robots/{name}",
    summary="Describe a robot",
    response_model=RobotInfo,
    responses=problems(errors.RobotNotFound, *WORKER_ERRORS),
)
async def get_robot(request: Request, name: str) -> Response:
    """Return one robot with its joints, limits, home, frames, sources and the shapes of links."""
    if is_upload_id(name):
        return Response((await stored_robot(request, name)).info, media_type=_JSON)
    described: dict[str, bytes] = request.app.state.described
    if name not in described:
        planner: Planner = request.app.state.planner
        work = planner.run("describe-robot", name.encode(), wait_if_full=True)
        described[name] = (await while_connected(request, work)).document
    return Response(described[name], media_type=_JSON)


@router.delete(
    "/robots/{name}",
    summary="Delete an uploaded robot",
    status_code=204,
    response_class=Response,
    responses=problems(errors.RobotNotFound, errors.InvalidRequest),
)
async def delete_robot(request: Request, name: str) -> Response:
    """Delete an uploaded robot, but not its plans. Robots of the catalogue cannot be deleted."""
    if not is_upload_id(name):
        robot = await asyncio.to_thread(catalogue_robot, name)
        raise Refusal(
            errors.InvalidRequest(
                f"{robot.name!r} is a robot of the catalogue; only uploaded ones can be deleted",
                field="name",
            ),
            status=403,
        )
    await stored_robot(request, name)
    store: DocumentStore = request.app.state.robots
    await store.delete(name, owner_of(request))
    return Response(status_code=204)


@router.get("/solvers", summary="List the solvers", response_model=SolverList, responses=problems())
async def list_solvers() -> Response:
    """Return every solver with its source, its parameters and their defaults."""
    document = await asyncio.to_thread(tasks.solvers_document)
    return Response(document, media_type=_JSON)
