"""Metrics for monitoring."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan_api.http.openapi import problems
from ikplan_api.telemetry.metrics import MEDIA_TYPE, Metrics

__all__ = ["router"]

router = APIRouter(tags=["health"])


@router.get(
    "/metrics",
    summary="Metrics for Prometheus",
    response_class=Response,
    responses={
        200: {"content": {"text/plain": {"schema": {"type": "string"}}}},
        **problems(),
    },
)
async def get_metrics(request: Request) -> Response:
    """Return load, tasks by outcome, durations of stages and requests, margins of plans."""
    metrics: Metrics = request.app.state.metrics
    return Response(metrics.text(), headers={"content-type": MEDIA_TYPE})
