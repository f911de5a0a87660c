"""Plans: create, fetch, watch and cancel them."""

from __future__ import annotations

from collections.abc import AsyncIterator
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent

from ikplan import errors
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.status import Outcome, PlanList
from ikplan.plans.plan import Plan
from ikplan_api.handlers.plan_events import Watched, find_watched
from ikplan_api.handlers.plan_responses import (
    ACCEPTED,
    PLANS,
    PREFER,
    create_plan_response,
    get_plan_response,
)
from ikplan_api.handlers.point_files import csv_body, with_notes
from ikplan_api.http.openapi import plan_answers, problems, request_body
from ikplan_api.http.owner import owner_of
from ikplan_api.jobs.job_service import JobService
from ikplan_api.store.plan_query import PlanQuery, page_of, read_cursor

__all__ = ["PLAN_ERRORS", "router"]

router = APIRouter(prefix=PLANS, tags=["plans"])

PLAN_ERRORS = (
    errors.Unreachable,
    errors.Disconnected,
    errors.InCollision,
    errors.TimingFailed,
    errors.BudgetExceeded,
    errors.MemoryExceeded,
    errors.WorkerLost,
    errors.CertificateViolated,
    errors.ServiceUnavailable,
)
"""Errors of valid requests."""
_EXAMPLE = {
    "robot": "iiwa14",
    "path": {
        "waypoints": [
            {"position": [0.6, 0.0, 0.4], "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]},
            {"position": [0.6, 0.2, 0.4]},
        ]
    },
}


def _described() -> dict[str, Any]:
    """Return the OpenAPI description of the bodies and parameters of a request for a plan."""
    described = request_body(PlanRequest, _EXAMPLE)
    content, parameters = csv_body()
    described["requestBody"]["content"] |= content
    return {**described, "parameters": [*PREFER["parameters"], *parameters]}


@router.post(
    "",
    summary="Plan a tool path",
    response_model=Plan,
    responses=with_notes(
        ACCEPTED | plan_answers(errors.InvalidRequest, errors.RobotNotFound, *PLAN_ERRORS)
    ),
    openapi_extra=_described(),
)
async def create_plan(request: Request) -> Response:
    """Plan a joint trajectory for a tool path and verify it before it is returned.

    The body is a request document, or a CSV file of poses or joint values with further options in
    the query; the header `Ikplan-Notes` of the response then says how the file was read.

    The same request gives the same id and the same trajectory, byte for byte; a stored plan is not
    planned again. With `Prefer: respond-async` the service plans in the background, even after a
    restart, and the plan appears at the `Location` of the response.
    """
    return await create_plan_response(request, "plan")


@router.get(
    "",
    summary="List plans and jobs",
    responses=problems(errors.InvalidRequest, errors.ServiceUnavailable, body=False),
)
async def list_plans(
    request: Request,
    robot: Annotated[
        str | None, Query(max_length=200, description="Only those of this robot.")
    ] = None,
    outcome: Annotated[Outcome | None, Query(description="Only those of this outcome.")] = None,
    since: Annotated[
        datetime | None, Query(description="Only those of this time or later (RFC 3339).")
    ] = None,
    until: Annotated[
        datetime | None, Query(description="Only those before this time (RFC 3339).")
    ] = None,
    limit: Annotated[int, Query(ge=1, le=1000, description="Most plans of a page.")] = 100,
    after: Annotated[
        str | None, Query(max_length=400, description="The `next` of the page before.")
    ] = None,
) -> PlanList:
    """List the stored plans and the jobs, the newest first.

    A failed request is listed if it was a job; an answer to a waiting client is not stored. A key
    sees its own plans only.
    """
    jobs: JobService = request.app.state.plan_jobs
    query = PlanQuery(
        owner=owner_of(request),
        limit=limit,
        robot=robot,
        outcome=outcome,
        since=_seconds(since),
        until=_seconds(until),
        after=None if after is None else read_cursor(after),
    )
    return page_of(await jobs.list(query), limit)


def _seconds(moment: datetime | None) -> float | None:
    """Return the seconds since 1970; a time without an offset is in UTC."""
    if moment is None:
        return None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


@router.get(
    "/{plan_id}",
    summary="Fetch a plan",
    response_model=Plan,
    responses=ACCEPTED
    | {304: {"description": "The client has the current plan"}}
    | plan_answers(
        errors.PlanNotFound,
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.InvalidRobot,
        *PLAN_ERRORS,
        body=False,
    ),
)
async def get_plan(request: Request, plan_id: str) -> Response:
    """Return a stored plan.

    While the plan is in progress, return 202 and its progress; if the job failed, its problem.
    """
    return await get_plan_response(request, plan_id)


@router.delete(
    "/{plan_id}",
    summary="Cancel or delete a plan",
    status_code=204,
    responses=problems(errors.PlanNotFound),
)
async def delete_plan(request: Request, plan_id: str) -> None:
    """Cancel a job, or delete a finished plan.

    Clients that wait for the response to the same request still receive it.
    """
    jobs: JobService = request.app.state.plan_jobs
    await jobs.cancel(plan_id, owner_of(request))


@router.get(
    "/{plan_id}/events",
    summary="Watch a plan in progress",
    response_class=EventSourceResponse,
    responses=problems(errors.PlanNotFound),
)
async def watch_plan(
    watched: Annotated[Watched, Depends(find_watched)],
) -> AsyncIterator[ServerSentEvent]:
    """Stream server-sent events: `progress` events with the status, then a final event.

    The final event is `finished`, `cancelled`, or `failed` with the problem document.
    """
    async for event in watched.events():
        yield event
