"""Files of points, converted to a request without planning."""

from __future__ import annotations

import json
from typing import Any

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan_api.handlers.point_files import FILES, file_body, read_points_request
from ikplan_api.http.body import read_body
from ikplan_api.http.openapi import WORKER_ERRORS, problems
from ikplan_api.http.schemas import PointsRead

__all__ = ["router"]

router = APIRouter(prefix="/v1", tags=["plans"])


def _described() -> dict[str, Any]:
    content, parameters = file_body()
    return {"requestBody": {"required": True, "content": content}, "parameters": parameters}


@router.post(
    "/points",
    summary="Read a file of points",
    response_model=PointsRead,
    responses=problems(errors.InvalidRequest, errors.RobotNotFound, *WORKER_ERRORS),
    openapi_extra=_described(),
)
async def read_points(request: Request) -> Response:
    """Convert a file of points or G-code to a request, with notes on how it was read.

    Column names identify quaternions, rotation vectors, KUKA A, B, C, FANUC W, P, R, roll, pitch
    and yaw, tool axes, speeds and zones. Moves of G-code are G0 to G3. `POST /v1/plans` accepts
    the same file and plans it.
    """
    limit: int = request.app.state.settings.max_body_bytes
    body = await read_body(request, list(FILES), limit)
    document, notes = await read_points_request(request, body)
    listed = json.dumps([{"text": note.text, "guessed": note.guessed} for note in notes])
    return Response(
        b'{"request": %b, "notes": %b}' % (document, listed.encode()), media_type="application/json"
    )
