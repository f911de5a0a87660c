"""How plans are asked for and answered, whatever they are made from."""

from __future__ import annotations

import json
from typing import Any

from fastapi import Request, Response

from ikplan.documents.status import PlanStatus
from ikplan.errors import PlanNotFound
from ikplan.export.formats import Format
from ikplan_api.board import PlanBoard
from ikplan_api.body import read_json_body
from ikplan_api.disconnect import while_connected
from ikplan_api.problems import problem_response, request_id_of
from ikplan_api.representations import accepted_format, plan_answer
from ikplan_api.uploads import robot_document

__all__ = ["ACCEPTED", "PLANS", "PREFER", "ask_for_plan", "kept_plan"]

PLANS = "/v1/plans"

_ASYNC = "respond-async"
PREFER: dict[str, Any] = {
    "parameters": [
        {
            "name": "Prefer",
            "in": "header",
            "description": f"`{_ASYNC}`: accept the request as a job, instead of waiting for the "
            "plan (RFC 7240).",
            "schema": {"type": "string"},
            "example": _ASYNC,
        }
    ]
}
"""The header by which a caller asks not to wait, for the OpenAPI document."""
ACCEPTED: dict[int | str, dict[str, Any]] = {
    202: {
        "model": PlanStatus,
        "description": "The plan is not finished yet",
        "headers": {
            "Location": {
                "description": "Where the plan will be.",
                "schema": {"type": "string", "format": "uri-reference"},
            }
        },
    }
}
"""The answer that there will be a plan, for the OpenAPI document."""


async def ask_for_plan(request: Request, kind: str) -> Response:
    """Answer a request for a plan: with it, or that it will be made.

    Args:
        request: The request.
        kind: ``"plan"`` or ``"time"``.

    Raises:
        IkplanError: The verdict on the request.
    """
    board: PlanBoard = request.app.state.board
    form = accepted_format(request)
    document = await read_json_body(request)
    robot = await robot_document(request, document)
    job = await board.identify(kind, document, robot)
    if not _prefers_async(request):
        made = await while_connected(request, board.make(job))
    elif (kept := await board.find(job.plan_id)) is not None:
        made = kept
    else:
        return _pending(await board.accept(job), applied=True)
    return await _finished(request, job.plan_id, made, form)


async def kept_plan(request: Request, plan_id: str) -> Response:
    """Answer what there is under an id: a plan, how far it is, or why there is none.

    Raises:
        PlanNotFound: Nothing is known under that id.
    """
    board: PlanBoard = request.app.state.board
    form = accepted_format(request)
    if (document := await board.find(plan_id)) is not None:
        etag = _etag(plan_id, form)
        if etag in _tags(request, "if-none-match"):
            return Response(status_code=304, headers={"etag": etag, "vary": "Accept"})
        return await _finished(request, plan_id, document, form)
    if (making := board.under_way(plan_id)) is not None:
        return _pending(making.status)
    if (problem := await board.failure(plan_id)) is not None:
        return problem_response(problem, request_id_of(request))
    raise PlanNotFound(id=plan_id)


async def _finished(request: Request, plan_id: str, document: bytes, form: Format) -> Response:
    headers = {"content-location": f"{PLANS}/{plan_id}", "etag": _etag(plan_id, form)}
    return await plan_answer(request, document, form, headers)


def _pending(status: PlanStatus, *, applied: bool = False) -> Response:
    headers = {"location": f"{PLANS}/{status.id}", "retry-after": "1"}
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
    """The entity tags of a header; a weak one counts as its strong twin."""
    values = ",".join(request.headers.getlist(header)).split(",")
    return {value.strip().removeprefix("W/") for value in values}


def _prefers_async(request: Request) -> bool:
    preferences = ",".join(request.headers.getlist("prefer")).split(",")
    return any(p.partition(";")[0].strip().lower() == _ASYNC for p in preferences)
