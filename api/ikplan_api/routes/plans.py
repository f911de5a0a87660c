"""Plans: make one, fetch one, watch one, cancel one."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent

from ikplan import errors
from ikplan.request import PlanRequest
from ikplan.result import Plan
from ikplan_api.answering import ACCEPTED, PLANS, PREFER, ask_for_plan, kept_plan
from ikplan_api.board import PlanBoard
from ikplan_api.openapi import plan_answers, problems, request_body
from ikplan_api.watching import Watched, find_watched

__all__ = ["PLAN_ERRORS", "router"]

router = APIRouter(prefix=PLANS, tags=["plans"])

PLAN_ERRORS = (
    errors.Unreachable,
    errors.Disconnected,
    errors.TimingFailed,
    errors.BudgetExceeded,
    errors.MemoryExceeded,
    errors.WorkerLost,
    errors.CertificateViolated,
    errors.ServiceUnavailable,
)
"""What can become of a request that makes sense."""
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
    responses=ACCEPTED | plan_answers(errors.InvalidRequest, errors.RobotNotFound, *PLAN_ERRORS),
    openapi_extra=request_body(PlanRequest, _EXAMPLE) | PREFER,
)
async def create_plan(request: Request) -> Response:
    """Turn a path of the tool into a joint trajectory, checked before it is answered.

    The same request gives the same id and the same trajectory, byte for byte; while the plan is
    kept, it is not made again. With `Prefer: respond-async` it is made later, and found at the
    `Location` of the answer, even if the service is restarted in between.
    """
    return await ask_for_plan(request, "plan")


@router.get(
    "/{plan_id}",
    summary="Fetch a plan",
    response_model=Plan,
    responses=ACCEPTED
    | {304: {"description": "The caller has it already"}}
    | plan_answers(
        errors.PlanNotFound,
        errors.InvalidRequest,
        errors.RobotNotFound,
        errors.InvalidRobot,
        *PLAN_ERRORS,
        body=False,
    ),
)
async def get_plan(request: Request, plan_id: str) -> Response:
    """Return a plan, as it was answered, while it is kept.

    While it is being made, 202 and how far it is; if the job failed, why.
    """
    return await kept_plan(request, plan_id)


@router.delete(
    "/{plan_id}",
    summary="Cancel or forget a plan",
    status_code=204,
    responses=problems(errors.PlanNotFound),
)
async def delete_plan(request: Request, plan_id: str) -> None:
    """Stop a job and forget it, or forget a finished plan.

    Who waits for the answer to the same request gets it all the same.
    """
    board: PlanBoard = request.app.state.board
    await board.cancel(plan_id)


@router.get(
    "/{plan_id}/events",
    summary="Watch a plan being made",
    response_class=EventSourceResponse,
    responses=problems(errors.PlanNotFound),
)
async def watch_plan(
    watched: Annotated[Watched, Depends(find_watched)],
) -> AsyncIterator[ServerSentEvent]:
    """Server-sent events, each with how far the plan is: `progress`, and at last one more.

    The last one is `finished`, `cancelled`, or `failed` with the problem document.
    """
    async for event in watched.events():
        yield event
