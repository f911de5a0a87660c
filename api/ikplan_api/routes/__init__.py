"""The endpoints, one file for each subject."""

from __future__ import annotations

from fastapi import APIRouter

from ikplan_api.routes import (
    audit,
    batches,
    docs,
    health,
    metrics,
    outputs,
    page,
    plans,
    points,
    poses,
    robots,
    scenes,
    timings,
    visuals,
)

__all__ = ["ROUTERS"]

ROUTERS: tuple[APIRouter, ...] = (
    plans.router,
    points.router,
    batches.router,
    timings.router,
    poses.router,
    robots.router,
    scenes.router,
    visuals.router,
    outputs.router,
    audit.router,
    health.router,
    metrics.router,
    docs.router,
    page.router,
)
