"""Figures for an operator's monitoring."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from ikplan_api.metrics import MEDIA_TYPE, Metrics
from ikplan_api.openapi import problems

__all__ = ["router"]

router = APIRouter(tags=["health"])


@router.get(
    "/metrics",
    summary="Figures for Prometheus",
    response_class=Response,
    responses={
        200: {"content": {"text/plain": {"schema": {"type": "string"}}}},
        **problems(),
    },
)
async def get_metrics(request: Request) -> Response:
    """Return queue, tasks by outcome, times of stages and requests, margins of certificates."""
    metrics: Metrics = request.app.state.metrics
    return Response(metrics.text(), headers={"content-type": MEDIA_TYPE})
