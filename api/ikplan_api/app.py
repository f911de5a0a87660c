"""The ASGI application."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
from collections.abc import AsyncIterator
from typing import Any

from fastapi import FastAPI

import ikplan
from ikplan_api import openapi, problems
from ikplan_api.board import PlanBoard
from ikplan_api.measured import MeasuredPlanner
from ikplan_api.metrics import Metrics
from ikplan_api.observing import is_probe
from ikplan_api.planner import Planner
from ikplan_api.pool import ProcessPlanner
from ikplan_api.robot_builder import RobotBuilder
from ikplan_api.robot_store import MemoryRobotStore, RobotStore
from ikplan_api.routes import ROUTERS
from ikplan_api.settings import Settings, load_settings, unknown_variables
from ikplan_api.sqlite_robots import SqliteRobotStore
from ikplan_api.sqlite_store import SqliteStore
from ikplan_api.stopping import Stopping
from ikplan_api.store import PlanStore
from ikplan_api.wrapping import wrap

__all__ = ["create_app"]

_log = logging.getLogger("ikplan.service")


def create_app(
    settings: Settings | None = None,
    *,
    planner: Planner | None = None,
    store: PlanStore | None = None,
    robots: RobotStore | None = None,
) -> FastAPI:
    """Put the service together.

    Args:
        settings: What the operator set; None: read from the environment.
        planner: Who plans; None: as many processes as the settings say.
        store: Where plans and jobs are kept; None: where the settings say.
        robots: Where uploaded robots are kept; None: where the plans are, else in memory.

    Returns:
        The application. Its lifespan warms the planner up in the background, so that ``/livez``
        answers at once and ``/readyz`` when the first request would not wait for a compiler.

    Raises:
        InvalidRequest: An environment variable has a value that is not allowed, or cannot be
            used.
    """
    settings = settings if settings is not None else load_settings()
    app = FastAPI(
        title="ikplan",
        version=ikplan.__version__,
        summary="A tool path in, a certified joint trajectory out.",
        description=(
            "SI units: metres, radians, seconds. Quaternions are (x, y, z, w). Every failure is "
            "an RFC 9457 problem document with the data of one class of error."
        ),
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        generate_unique_id_function=openapi.operation_id,
        lifespan=_lifespan,
        # Traces go where OTEL_EXPORTER_OTLP_ENDPOINT says; Prometheus has the figures already.
        telemetry={"auto_configure": True, "metrics": False, "exclude": is_probe},
    )
    app.state.settings = settings
    planner = planner or ProcessPlanner(
        settings.worker_count,
        settings.max_queued,
        memory_bytes=settings.worker_memory_bytes,
        grace_s=settings.grace_s,
    )
    app.state.metrics = Metrics(planner)
    app.state.planner = MeasuredPlanner(planner, app.state.metrics)
    app.state.store = store or _store(settings)
    app.state.board = PlanBoard(app.state.planner, app.state.store, settings.max_budget_s)
    app.state.stopping = Stopping(app.state.board, settings.stop_s)
    app.state.robots = robots or _robots(settings, app.state.store)
    app.state.robot_builder = RobotBuilder(settings.robot_memory_bytes, settings.robot_timeout_s)
    for router in ROUTERS:
        app.include_router(router)
    problems.install(app, ROUTERS)
    openapi.install(app)
    wrap(app, settings, app.state.metrics)
    return app


def _store(settings: Settings) -> SqliteStore:
    store = SqliteStore(
        settings.store_path,
        settings.store_plans,
        settings.store_bytes,
        max_age_s=settings.store_days * 86400.0,
    )
    store.check()  # now, where a wrong setting is told in one line
    return store


def _robots(settings: Settings, store: PlanStore) -> RobotStore:
    bounds = settings.store_robots, settings.store_robot_bytes
    if isinstance(store, SqliteStore):
        return SqliteRobotStore(store, *bounds)
    return MemoryRobotStore(*bounds)


@contextlib.asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[dict[str, Any]]:
    for name, near in unknown_variables(os.environ).items():
        meant = f"; is {near[0]} meant?" if near else ""
        _log.warning("%s is set, but there is no such setting%s", name, meant)
    stopping: Stopping = app.state.stopping
    planner: Planner = app.state.planner
    store: PlanStore = app.state.store
    await store.open()
    await app.state.board.resume()
    warming = asyncio.create_task(planner.warm_up())
    warming.add_done_callback(_report)
    try:
        # For whoever serves: to be called as soon as the service is to stop.
        yield {"stop": stopping.begin}
    finally:
        warming.cancel()
        await stopping.settle()
        await planner.close()
        await app.state.board.close()
        await store.close()


def _report(warming: asyncio.Task[None]) -> None:
    """A service that cannot warm up stays unready; the log has to say why."""
    if not warming.cancelled() and (error := warming.exception()) is not None:
        _log.error("warming up failed", exc_info=error)
