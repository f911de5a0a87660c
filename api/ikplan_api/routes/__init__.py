"""The endpoints, one file a subject."""

from __future__ import annotations

from fastapi import APIRouter

from ikplan_api.routes import docs, health, plans, poses, robots, timings

__all__ = ["ROUTERS"]

ROUTERS: tuple[APIRouter, ...] = (
    plans.router,
    timings.router,
    poses.router,
    robots.router,
    health.router,
    docs.router,
)
