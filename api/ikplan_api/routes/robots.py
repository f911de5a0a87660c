"""What there is to plan with: robots and solvers."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter, Response

from ikplan import errors
from ikplan.robots import RobotInfo, catalogue_robot
from ikplan_api import tasks
from ikplan_api.openapi import problems
from ikplan_api.schemas import RobotList, SolverList

__all__ = ["router"]

router = APIRouter(prefix="/v1", tags=["robots and solvers"])


@router.get("/robots", summary="List the robots", response_model=RobotList, responses=problems())
async def list_robots() -> Response:
    """Return every robot of the catalogue with its joints, limits, home, frames and sources."""
    document = await asyncio.to_thread(tasks.robots_document)
    return Response(document, media_type="application/json")


@router.get(
    "/robots/{name}",
    summary="Describe a robot",
    response_model=RobotInfo,
    responses=problems(errors.RobotNotFound),
)
async def get_robot(name: str) -> Response:
    """Return one robot with its joints, limits, home, frames and sources."""
    robot = await asyncio.to_thread(catalogue_robot, name)
    return Response(robot.info().model_dump_json(), media_type="application/json")


@router.get("/solvers", summary="List the solvers", response_model=SolverList, responses=problems())
async def list_solvers() -> Response:
    """Return every solver with its source, its parameters and their defaults."""
    document = await asyncio.to_thread(tasks.solvers_document)
    return Response(document, media_type="application/json")
