"""Liveness, readiness and version."""

from __future__ import annotations

from fastapi import APIRouter, Request

import ikplan
from ikplan import errors
from ikplan_api.http.openapi import problems
from ikplan_api.http.schemas import State, Version
from ikplan_api.workers.planner import Planner

__all__ = ["router"]

router = APIRouter(tags=["health"])


@router.get("/livez", summary="Liveness", responses=problems())
async def livez() -> State:
    """Return 200 while the service runs, however busy the workers are."""
    return State(status="alive")


@router.get("/readyz", summary="Readiness", responses=problems(errors.ServiceUnavailable))
async def readyz(request: Request) -> State:
    """Return 200 once the kernels are compiled and a small plan succeeded, 503 before."""
    planner: Planner = request.app.state.planner
    if not planner.ready:
        raise errors.ServiceUnavailable(
            "the service is warming up", status_code=503, retry_after_s=1.0
        )
    return State(status="ready")


@router.get("/version", summary="Version", responses=problems())
async def get_version() -> Version:
    """Return the version of ikplan that the service runs."""
    return Version(version=ikplan.__version__)
