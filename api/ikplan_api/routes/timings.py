"""Timings: a joint path of one's own, timed and certified without planning."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.result import Plan
from ikplan.timing_request import TimingRequest
from ikplan_api.body import read_json_body
from ikplan_api.disconnect import while_connected
from ikplan_api.identity import identify
from ikplan_api.openapi import problems, request_body
from ikplan_api.planner import Planner
from ikplan_api.routes import plans
from ikplan_api.store import PlanStore
from ikplan_api.uploads import robot_document

__all__ = ["router"]

router = APIRouter(prefix="/v1/timings", tags=["plans"])

_EXAMPLE = {
    "robot": "ur5",
    "waypoints": [
        [0.0, -1.57, 1.57, 0.0, 1.0, 0.0],
        [0.4, -1.2, 1.3, 0.1, 1.0, 0.2],
        [0.8, -1.4, 1.6, 0.0, 1.0, 0.0],
    ],
    "limits": {"velocity_scale": 0.5, "torque": True},
}


@router.post(
    "",
    summary="Time a joint path",
    response_model=Plan,
    responses=problems(
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.TimingFailed,
        errors.BudgetExceeded,
        errors.MemoryExceeded,
        errors.WorkerLost,
        errors.CertificateViolated,
        errors.ServiceUnavailable,
    ),
    openapi_extra=request_body(TimingRequest, _EXAMPLE),
)
async def create_timing(request: Request) -> Response:
    """Move through joint waypoints as fast as the limits allow, checked before it is answered.

    The same request gives the same id and the same trajectory, byte for byte.
    """
    planner: Planner = request.app.state.planner
    store: PlanStore = request.app.state.store
    document = await read_json_body(request)
    robot = await robot_document(request, document)
    identity = await identify(planner, "time", document, robot)
    answer = await while_connected(
        request, planner.run("time", document, robot=robot, limit_s=identity.budget_s)
    )
    headers = {}
    if answer.plan_id is not None:
        await store.put(answer.plan_id, answer.document)
        headers["content-location"] = f"{plans.router.prefix}/{answer.plan_id}"
    return Response(answer.document, media_type="application/json", headers=headers)
