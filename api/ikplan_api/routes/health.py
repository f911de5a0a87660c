"""What an operator's probes ask."""

from __future__ import annotations

from fastapi import APIRouter, Request

import ikplan
from ikplan import errors
from ikplan_api.openapi import problems
from ikplan_api.planner import Planner
from ikplan_api.schemas import State, Version

__all__ = ["router"]

router = APIRouter(tags=["health"])


@router.get("/livez", summary="Is the service alive?", responses=problems())
async def livez() -> State:
    """Answer, whatever the workers do."""
    return State(status="alive")


@router.get(
    "/readyz", summary="Is the service warm?", responses=problems(errors.ServiceUnavailable)
)
async def readyz(request: Request) -> State:
    """Answer 200 once the kernels are compiled and a tiny plan has been made, 503 before."""
    planner: Planner = request.app.state.planner
    if not planner.ready:
        raise errors.ServiceUnavailable(
            "the service is warming up", status_code=503, retry_after_s=1.0
        )
    return State(status="ready")


@router.get("/version", summary="Which version is this?", responses=problems())
async def get_version() -> Version:
    """Return the version of ikplan that answers."""
    return Version(version=ikplan.__version__)
