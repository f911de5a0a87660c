"""Batches: many requests, many plans."""

from __future__ import annotations

import json
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import StreamingResponse

from ikplan import errors
from ikplan_api.batch import NDJSON, answer_lines, split_lines
from ikplan_api.body import read_body
from ikplan_api.openapi import problems
from ikplan_api.planner import Planner
from ikplan_api.schemas import BatchLine
from ikplan_api.settings import Settings

__all__ = ["router"]

router = APIRouter(prefix="/v1/batches", tags=["plans"])

_TYPES = [NDJSON, "application/jsonl", "application/json-lines"]
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "A line for each request, in their order",
        "content": {NDJSON: {"schema": {"$ref": f"#/components/schemas/{BatchLine.__name__}"}}},
    }
}
_EXAMPLE = "\n".join(
    json.dumps({"robot": "iiwa14", "path": {"waypoints": [{"position": position}]}})
    for position in ([0.6, 0.0, 0.4], [0.6, 0.0, 9.0])
)


@router.post(
    "",
    summary="Make many plans",
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
    """Plan every line, a request as for `POST /v1/plans`, and answer each with a line.

    The answers come in the order of the requests, each as soon as it and those before it are
    known. A request that fails spoils no other: its line has the `problem` in place of the
    `plan`. A batch waits for room in the queue instead of being refused.
    """
    settings: Settings = request.app.state.settings
    planner: Planner = request.app.state.planner
    body = await read_body(request, _TYPES, settings.max_batch_bytes)
    lines = split_lines(body, settings.max_batch_lines)
    answers = answer_lines(request, lines, at_once=2 * planner.load.workers)
    return StreamingResponse(answers, media_type=NDJSON)
