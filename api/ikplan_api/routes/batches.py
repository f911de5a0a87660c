"""Batches: many requests for plans in one."""

from __future__ import annotations

import json
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import StreamingResponse

from ikplan import errors
from ikplan_api.handlers.batch_lines import NDJSON, plan_lines, split_lines
from ikplan_api.http.body import read_body
from ikplan_api.http.openapi import problems
from ikplan_api.http.schemas import BatchLine
from ikplan_api.settings import Settings
from ikplan_api.workers.planner import Planner

__all__ = ["router"]

router = APIRouter(prefix="/v1/batches", tags=["plans"])

_TYPES = [NDJSON, "application/jsonl", "application/json-lines"]
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "One line for each request, in order",
        "content": {NDJSON: {"schema": {"$ref": f"#/components/schemas/{BatchLine.__name__}"}}},
    }
}
_EXAMPLE = "\n".join(
    json.dumps({"robot": "iiwa14", "path": {"waypoints": [{"position": position}]}})
    for position in ([0.6, 0.0, 0.4], [0.6, 0.0, 9.0])
)


@router.post(
    "",
    summary="Plan a batch of requests",
    response_class=StreamingResponse,
    responses=_ANSWERS | problems(errors.InvalidRequest),
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                kind: {"schema": {"type": "string"}, "example": _EXAMPLE} for kind in _TYPES
            },
        }
    },
)
async def create_batch(request: Request) -> StreamingResponse:
    """Plan every line, a request as for `POST /v1/plans`, and return a line for each.

    The lines come in the order of the requests, each as soon as it and those before it are
    finished. A failed request does not affect the others: its line has a `problem` instead of a
    `plan`. If the queue is full, a batch waits instead of being refused.
    """
    settings: Settings = request.app.state.settings
    planner: Planner = request.app.state.planner
    body = await read_body(request, _TYPES, settings.max_batch_bytes)
    lines = split_lines(body, settings.max_batch_lines)
    answers = plan_lines(request, lines, concurrency=2 * planner.load.workers)
    return StreamingResponse(answers, media_type=NDJSON)
