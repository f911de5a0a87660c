"""Single poses: joint values to tool pose, and back."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.request import FkRequest, IkRequest
from ikplan.result import FkResult, IkSolution
from ikplan_api.body import read_json_body
from ikplan_api.disconnect import while_connected
from ikplan_api.openapi import problems, request_body
from ikplan_api.planner import Planner
from ikplan_api.uploads import robot_document

__all__ = ["router"]

router = APIRouter(prefix="/v1", tags=["poses"])


async def _answer(request: Request, kind: str) -> Response:
    planner: Planner = request.app.state.planner
    document = await read_json_body(request)
    robot = await robot_document(request, document)
    answer = await while_connected(request, planner.run(kind, document, robot=robot))
    return Response(answer.document, media_type="application/json")


@router.post(
    "/fk",
    summary="Place the tool",
    response_model=FkResult,
    responses=problems(
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.BudgetExceeded,
        errors.MemoryExceeded,
        errors.WorkerLost,
        errors.ServiceUnavailable,
    ),
    openapi_extra=request_body(FkRequest, {"robot": "ur5", "q": [0.0, -1.2, 1.5, 0.0, 1.0, 0.0]}),
)
async def compute_fk(request: Request) -> Response:
    """Return the tool's pose, in the base, at given joint values."""
    return await _answer(request, "fk")


@router.post(
    "/ik",
    summary="Find joint values",
    response_model=IkSolution,
    responses=problems(
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.Unreachable,
        errors.BudgetExceeded,
        errors.MemoryExceeded,
        errors.WorkerLost,
        errors.ServiceUnavailable,
    ),
    openapi_extra=request_body(IkRequest, {"robot": "iiwa14", "position": [0.5, 0.0, 0.5]}),
)
async def solve_ik(request: Request) -> Response:
    """Return the joint values nearest to the start that bring the tool to a pose."""
    return await _answer(request, "ik")
