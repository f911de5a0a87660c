"""Timings: a given joint path, timed and certified without planning."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.documents.timing_request import TimingRequest
from ikplan.plans.plan import Plan
from ikplan_api.handlers.plan_responses import ACCEPTED, PREFER, create_plan_response
from ikplan_api.http.openapi import plan_answers, request_body

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
    responses=ACCEPTED
    | plan_answers(
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.InCollision,
        errors.TimingFailed,
        errors.BudgetExceeded,
        errors.MemoryExceeded,
        errors.WorkerLost,
        errors.CertificateViolated,
        errors.ServiceUnavailable,
    ),
    openapi_extra=request_body(TimingRequest, _EXAMPLE) | PREFER,
)
async def create_timing(request: Request) -> Response:
    """Time a path through joint waypoints as fast as the limits allow, and verify the result.

    The same request gives the same id and the same trajectory, byte for byte. The result is stored
    like a plan, and `Prefer: respond-async` works as for plans.
    """
    return await create_plan_response(request, "time")
