"""Single poses: forward and inverse kinematics."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.documents import parse_json
from ikplan.documents.pose_results import FkResult, IkBatchSolution, IkSolution
from ikplan.documents.requests.fk import FkRequest
from ikplan.documents.requests.ik import IkBatchRequest, IkRequest
from ikplan_api.http.body import read_body
from ikplan_api.http.disconnect import while_connected
from ikplan_api.http.openapi import problems, request_body
from ikplan_api.robots.uploads import robot_document
from ikplan_api.scenes.uploads import with_stored_scene
from ikplan_api.settings import Settings
from ikplan_api.workers.planner import Planner

__all__ = ["router"]

router = APIRouter(prefix="/v1", tags=["poses"])

_JSON = "application/json"


_MAX_BYTES = 64 * 1024
"""Largest document of a pose [bytes]; the event loop parses it, so it must be short."""
_FK_S = 10.0
"""Time limit of forward kinematics, which takes microseconds [s]."""


async def _read(request: Request) -> bytes:
    settings: Settings = request.app.state.settings
    return await read_body(request, [_JSON], min(_MAX_BYTES, settings.max_body_bytes))


async def _answer(request: Request, kind: str, document: bytes, budget_s: float) -> Response:
    planner: Planner = request.app.state.planner
    settings: Settings = request.app.state.settings
    robot = await robot_document(request, document)
    limit_s = min(budget_s, settings.max_budget_s)
    work = planner.run(kind, document, robot=robot, limit_s=limit_s)
    answer = await while_connected(request, work)
    return Response(answer.document, media_type=_JSON)


@router.post(
    "/fk",
    summary="Compute forward kinematics",
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
    """Return the pose of the tool in the base for given joint values."""
    document = await _read(request)
    parse_json(FkRequest, document)
    return await _answer(request, "fk", document, _FK_S)


@router.post(
    "/ik",
    summary="Solve inverse kinematics",
    response_model=IkSolution,
    responses=problems(
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.Unreachable,
        errors.InCollision,
        errors.BudgetExceeded,
        errors.MemoryExceeded,
        errors.WorkerLost,
        errors.ServiceUnavailable,
    ),
    openapi_extra=request_body(IkRequest, {"robot": "iiwa14", "position": [0.5, 0.0, 0.5]}),
)
async def solve_ik(request: Request) -> Response:
    """Return the joint values nearest to the start that reach a tool pose.

    A search that takes longer than `budget_s` is cancelled.
    """
    document = await _read(request)
    budget_s = parse_json(IkRequest, document).budget_s
    return await _answer(request, "ik", await with_stored_scene(request, document), budget_s)


@router.post(
    "/ik/batch",
    summary="Solve inverse kinematics of many poses",
    response_model=IkBatchSolution,
    responses=problems(
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.BudgetExceeded,
        errors.MemoryExceeded,
        errors.WorkerLost,
        errors.ServiceUnavailable,
    ),
    openapi_extra=request_body(
        IkBatchRequest,
        {
            "robot": "iiwa14",
            "poses": [{"position": [0.5, 0.0, 0.5]}, {"position": [0.5, 0.1, 0.5]}],
            "verdict": False,
        },
    ),
)
async def solve_ik_batch(request: Request) -> Response:
    """Return joint values for many poses of one robot, each as `POST /v1/ik` finds them.

    A pose without a solution is one of the answer, not an error. `"verdict": false` does without
    the reasons, which cost most of the time. All poses have `budget_s` together.
    """
    settings: Settings = request.app.state.settings
    document = await read_body(request, [_JSON], settings.max_body_bytes)
    # A worker reads the document, and keeps to its budget.
    document = await with_stored_scene(request, document)
    return await _answer(request, "ik-batch", document, settings.max_budget_s)
