"""Timings: a joint path of one's own, timed and certified without planning."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan import errors
from ikplan.documents.timing import TimingRequest
from ikplan.result import Plan
from ikplan_api.answering import ACCEPTED, PREFER, ask_for_plan
from ikplan_api.openapi import plan_answers, request_body

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
    """Move through joint waypoints as fast as the limits allow, checked before it is answered.

    The same request gives the same id and the same trajectory, byte for byte. It is kept like a
    plan, and can be asked for like one with `Prefer: respond-async`.
    """
    return await ask_for_plan(request, "time")
