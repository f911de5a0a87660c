"""What plans are given out as: their formats, and their measures over time."""

from __future__ import annotations

import asyncio
import json

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.trajectory import PlanSeries
from ikplan.plans.export import FORMATS
from ikplan.plans.export.formats import Arm
from ikplan.robots import catalogue_robot, is_upload_id
from ikplan_api.http.body import read_json_body
from ikplan_api.http.disconnect import while_connected
from ikplan_api.http.openapi import WORKER_ERRORS, problems, request_body
from ikplan_api.http.owner import owner_of
from ikplan_api.http.schemas import FormatInfo, FormatList
from ikplan_api.jobs.job_service import JobService
from ikplan_api.robots.uploads import named_robot, stored_robot
from ikplan_api.scenes.uploads import with_stored_scene
from ikplan_api.workers.headed import headed
from ikplan_api.workers.planner import Planner

__all__ = ["router"]

router = APIRouter(prefix="/v1")

_EXAMPLE = {"robot": "iiwa14", "path": {"waypoints": [{"position": [0.6, 0.0, 0.4]}]}}


@router.get(
    "/robots/{name}/formats",
    tags=["robots and solvers"],
    summary="List the formats of a robot's plans",
    response_model=FormatList,
    responses=problems(errors.RobotNotFound, *WORKER_ERRORS),
)
async def list_formats(request: Request, name: str) -> FormatList:
    """Return every format that a robot's plans are available in, programs of its controller too.

    The media type is for the header `Accept` of a request for a plan.
    """
    if is_upload_id(name):
        arm = Arm.of_robot(json.loads((await stored_robot(request, name)).info))
    else:
        arm = await asyncio.to_thread(lambda: Arm.of_robot(catalogue_robot(name).info()))
    return FormatList(formats=_available(arm))


def _available(arm: Arm) -> list[FormatInfo]:
    found = []
    for form in FORMATS:
        try:
            form.check(arm)
        except errors.InvalidRequest:
            continue
        found.append(
            FormatInfo(
                name=form.name,
                title=form.title,
                suffix=form.suffixes[0],
                media_type=form.media_type,
            )
        )
    return found


@router.post(
    "/series",
    tags=["plans"],
    summary="Measure a plan over time",
    response_model=PlanSeries,
    responses=problems(
        errors.InvalidRequest, errors.RobotNotFound, errors.PlanNotFound, *WORKER_ERRORS
    ),
    openapi_extra=request_body(PlanRequest, _EXAMPLE),
)
async def measure_plan(request: Request) -> Response:
    """Return torques, deviation from the path and distances of the plan for a request.

    The body is the request document as for `POST /v1/plans`; its plan must be stored here.
    Nothing is planned.
    """
    jobs: JobService = request.app.state.plan_jobs
    planner: Planner = request.app.state.planner
    document = await with_stored_scene(request, await read_json_body(request))
    robot, known = await named_robot(request, "plan", document)
    owner = owner_of(request)
    job = await jobs.identify("plan", document, robot, known, owner=owner)
    plan = await jobs.find(job.plan_id, owner)
    if plan is None:
        raise errors.PlanNotFound(id=job.plan_id)
    work = planner.run("series", headed(document.decode(), plan), robot=robot)
    answer = await while_connected(request, work)
    return Response(answer.document, media_type="application/json")
