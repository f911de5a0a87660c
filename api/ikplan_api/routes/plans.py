"""Plans: make one, fetch one."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.request import PlanRequest
from ikplan.result import Plan
from ikplan_api.body import read_json_body
from ikplan_api.disconnect import while_connected
from ikplan_api.identity import identify
from ikplan_api.openapi import problems, request_body
from ikplan_api.planner import Planner
from ikplan_api.store import PlanStore
from ikplan_api.uploads import robot_document

__all__ = ["router"]

router = APIRouter(prefix="/v1/plans", tags=["plans"])

_EXAMPLE = {
    "robot": "iiwa14",
    "path": {
        "waypoints": [
            {"position": [0.6, 0.0, 0.4], "quaternion_xyzw": [0.0, 1.0, 0.0, 0.0]},
            {"position": [0.6, 0.2, 0.4]},
        ]
    },
}


@router.post(
    "",
    summary="Make a plan",
    response_model=Plan,
    responses=problems(
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.Unreachable,
        errors.Disconnected,
        errors.TimingFailed,
        errors.BudgetExceeded,
        errors.MemoryExceeded,
        errors.WorkerLost,
        errors.CertificateViolated,
        errors.ServiceUnavailable,
    ),
    openapi_extra=request_body(PlanRequest, _EXAMPLE),
)
async def create_plan(request: Request) -> Response:
    """Turn a path of the tool into a joint trajectory, checked before it is answered.

    The same request gives the same id and the same trajectory, byte for byte.
    """
    planner: Planner = request.app.state.planner
    store: PlanStore = request.app.state.store
    document = await read_json_body(request)
    robot = await robot_document(request, document)
    identity = await identify(planner, "plan", document, robot)
    answer = await while_connected(
        request, planner.run("plan", document, robot=robot, limit_s=identity.budget_s)
    )
    headers = {}
    if answer.plan_id is not None:
        await store.put(answer.plan_id, answer.document)
        headers["content-location"] = f"{router.prefix}/{answer.plan_id}"
    return Response(answer.document, media_type="application/json", headers=headers)


@router.get(
    "/{plan_id}",
    summary="Fetch a finished plan",
    response_model=Plan,
    responses=problems(errors.PlanNotFound),
)
async def get_plan(request: Request, plan_id: str) -> Response:
    """Return a plan made here before, as it was answered, while it is kept."""
    store: PlanStore = request.app.state.store
    document = await store.get(plan_id)
    if document is None:
        raise errors.PlanNotFound(id=plan_id)
    return Response(document, media_type="application/json")
