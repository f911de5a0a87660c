"""Responses to requests for plans, from a tool path or a joint path."""

from __future__ import annotations

import asyncio
import json
import math
from collections.abc import Mapping
from typing import Any

from fastapi import Request, Response

from ikplan.documents.status import PlanStatus
from ikplan.errors import InvalidRequest, PlanNotFound
from ikplan.plans.export.formats import Format
from ikplan.plans.plan import Plan
from ikplan_api.handlers.point_files import CSV, NOTES, is_csv, read_points_request, remember_notes
from ikplan_api.http.body import read_body, read_json_body
from ikplan_api.http.deadline import late, within_deadline
from ikplan_api.http.disconnect import while_connected
from ikplan_api.http.owner import owner_of
from ikplan_api.http.problems import problem_response, request_id_of
from ikplan_api.http.representations import (
    accepted_format,
    document_response,
    not_acceptable,
)
from ikplan_api.jobs.job_service import JobService
from ikplan_api.robots.uploads import named_robot
from ikplan_api.scenes.uploads import with_stored_scene
from ikplan_api.store.plan_store import Job
from ikplan_api.workers.planner import Planner

__all__ = ["ACCEPTED", "PLANS", "PREFER", "create_plan_response", "get_plan_response"]

PLANS = "/v1/plans"

_JSON = "application/json"
_SHORT = 128 * 1024
"""Longest plan that this process writes in another format, within some milliseconds [bytes]."""
_ASYNC = "respond-async"
PREFER: dict[str, Any] = {
    "parameters": [
        {
            "name": "Prefer",
            "in": "header",
            "description": f"`{_ASYNC}`: return at once and plan in the background (RFC 7240).",
            "schema": {"type": "string"},
            "example": _ASYNC,
        }
    ]
}
"""OpenAPI description of the header that requests an asynchronous response."""
ACCEPTED: dict[int | str, dict[str, Any]] = {
    202: {
        "model": PlanStatus,
        "description": "The plan is not finished yet",
        "headers": {
            "Location": {
                "description": "Address of the plan.",
                "schema": {"type": "string", "format": "uri-reference"},
            }
        },
    }
}
"""OpenAPI description of the response for an accepted job."""


async def create_plan_response(request: Request, kind: str) -> Response:
    """Return the plan for a request, or 202 if the client prefers not to wait.

    Args:
        request: The request.
        kind: ``"plan"`` or ``"time"``.

    Raises:
        IkplanError: The verdict on the request.
    """
    jobs: JobService = request.app.state.plan_jobs
    form = accepted_format(request)
    document = await (_plan_request(request) if kind == "plan" else read_json_body(request))
    async with within_deadline(request) as deadline_s:
        document = await with_stored_scene(request, document)
        robot, known = await named_robot(request, kind, document)
        job = await jobs.identify(kind, document, robot, known, owner=owner_of(request))
        if not _prefers_async(request):
            if math.isfinite(deadline_s):
                await _refuse_late(request, job, deadline_s)
            plan = await while_connected(request, jobs.run(job))
        elif (stored := await jobs.find(job.plan_id, job.owner)) is not None:
            plan = stored
        else:
            return _pending(await jobs.accept(job), applied=True, headers=_notes(request))
    return await _finished(request, job.plan_id, plan, form)


async def _refuse_late(request: Request, job: Job, deadline_s: float) -> None:
    """Refuse a request at once that would still wait for a worker at its deadline.

    Raises:
        ServiceUnavailable: A worker is expected to be free later.
    """
    jobs: JobService = request.app.state.plan_jobs
    planner: Planner = request.app.state.planner
    wait_s = planner.load.wait_s
    if wait_s <= deadline_s or await jobs.in_progress(job.plan_id, job.owner) is not None:
        return
    if await jobs.find(job.plan_id, job.owner) is None:
        raise late(f"a worker is expected to be free in {wait_s:.3g} s", deadline_s, wait_s)


async def _plan_request(request: Request) -> bytes:
    """Return the request document of a body in JSON, or in CSV with a query.

    Raises:
        InvalidRequest: The file or its query is invalid.
        Refusal: 413, too long; 415, neither JSON nor CSV.
    """
    limit: int = request.app.state.settings.max_body_bytes
    csv = is_csv(request)
    body = await read_body(request, [_JSON, CSV], limit)
    if not csv:
        return body
    document, notes = await read_points_request(request, body)
    remember_notes(request, notes)
    return document


async def get_plan_response(request: Request, plan_id: str) -> Response:
    """Return a stored plan, the progress of its job, or the problem if the job failed.

    Raises:
        PlanNotFound: No plan and no job has this id.
    """
    jobs: JobService = request.app.state.plan_jobs
    form, owner = accepted_format(request), owner_of(request)
    if (document := await jobs.find(plan_id, owner)) is not None:
        etag = _etag(plan_id, form)
        if etag in _tags(request, "if-none-match"):
            return Response(status_code=304, headers={"etag": etag, "vary": "Accept"})
        return await _finished(request, plan_id, document, form)
    if (in_progress := await jobs.in_progress(plan_id, owner)) is not None:
        return _pending(in_progress.status)
    if (problem := await jobs.failure(plan_id, owner)) is not None:
        return problem_response(problem, request_id_of(request))
    if (document := await jobs.find(plan_id, owner)) is not None:  # finished meanwhile
        return await _finished(request, plan_id, document, form)
    raise PlanNotFound(id=plan_id)


async def _finished(request: Request, plan_id: str, document: bytes, form: Format) -> Response:
    headers = {"content-location": f"{PLANS}/{plan_id}", "etag": _etag(plan_id, form)}
    headers |= _notes(request)
    if form.name != "json":
        document = await _exported(request, document, form)
    return document_response(request, document, form.media_type, {**headers, "vary": "Accept"})


async def _exported(request: Request, document: bytes, form: Format) -> bytes:
    """Return a plan in a format; long ones are written by a worker.

    Reading and writing hold the interpreter, 0.1 s for each megabyte.

    Raises:
        Refusal: 406, the format cannot represent this plan.
        ServiceUnavailable: The queue is full.
    """
    try:
        if len(document) <= _SHORT:
            return await asyncio.to_thread(lambda: form.encode(Plan.load(document)))
        planner: Planner = request.app.state.planner
        # A plan that was just made is not thrown away for a full queue.
        waits = request.method == "POST"
        exporting = planner.run(f"export-{form.name}", document, wait_if_full=waits)
        return (await while_connected(request, exporting)).document
    except InvalidRequest as error:
        raise not_acceptable(error.detail) from error


def _notes(request: Request) -> dict[str, str]:
    """Return the response header with the notes on how a file was read, if any."""
    notes = request.scope.get("state", {}).get("notes")
    return {NOTES: notes} if notes else {}


def _pending(
    status: PlanStatus, *, applied: bool = False, headers: Mapping[str, str] | None = None
) -> Response:
    headers = {**(headers or {}), "location": f"{PLANS}/{status.id}", "retry-after": "1"}
    if applied:
        headers["preference-applied"] = _ASYNC
    return Response(
        json.dumps(status.model_dump()),
        status_code=202,
        media_type="application/json",
        headers=headers,
    )


def _etag(plan_id: str, form: Format) -> str:
    return f'"{plan_id}"' if form.name == "json" else f'"{plan_id}-{form.name}"'


def _tags(request: Request, header: str) -> set[str]:
    """Return the entity tags of a header; a weak tag counts as the strong one."""
    values = ",".join(request.headers.getlist(header)).split(",")
    return {value.strip().removeprefix("W/") for value in values}


def _prefers_async(request: Request) -> bool:
    preferences = ",".join(request.headers.getlist("prefer")).split(",")
    return any(p.partition(";")[0].strip().lower() == _ASYNC for p in preferences)
