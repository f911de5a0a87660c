"""The ASGI application."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
from collections.abc import AsyncIterator, Callable
from typing import Any

from fastapi import FastAPI, Request, Response

import ikplan
from ikplan.errors import InvalidRequest, InvalidRobot
from ikplan.robots import robot_names
from ikplan.robots.folders import PATH_VARIABLE
from ikplan_api.connections.registry import ConnectionLimits, Connections, most_open
from ikplan_api.handlers.store_faults import unavailable
from ikplan_api.http import openapi, problems
from ikplan_api.jobs.job_service import JobService
from ikplan_api.jobs.plan_jobs import PlanJobs
from ikplan_api.jobs.shutdown import Shutdown
from ikplan_api.middleware.access_log import is_probe
from ikplan_api.middleware.install import install_middleware
from ikplan_api.robots.robot_builder import RobotBuilder
from ikplan_api.routes import ROUTERS
from ikplan_api.settings import Settings, load_settings, unknown_variables
from ikplan_api.store.document_store import DocumentStore, MemoryDocumentStore
from ikplan_api.store.plan_store import OpenStore, PlanStore, StoreFault
from ikplan_api.store.sqlite_documents import SqliteDocumentStore, Table
from ikplan_api.store.sqlite_plans import SqlitePlanStore
from ikplan_api.telemetry.loop_lag import watch_loop
from ikplan_api.telemetry.metrics import Metrics
from ikplan_api.workers.instrumented_planner import InstrumentedPlanner
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.process_planner import ProcessPlanner

__all__ = ["create_app"]

_log = logging.getLogger("ikplan.service")

Parts = tuple[OpenStore, JobService, Callable[[Table], DocumentStore]]
"""Store, jobs, and what makes the store of uploaded robots or scenes."""


def create_app(
    settings: Settings | None = None,
    *,
    planner: Planner | None = None,
    store: PlanStore | None = None,
    robots: DocumentStore | None = None,
    scenes: DocumentStore | None = None,
) -> FastAPI:
    """Create the application.

    Args:
        settings: The settings; None: read from the environment.
        planner: The planner; None: worker processes according to the settings.
        store: The store of plans and jobs; None: according to the settings.
        robots: The store of uploaded robots; None: in the file of the plans, else in memory.
        scenes: The store of uploaded scenes, likewise.

    Returns:
        The application. Its lifespan warms the planner up in the background: ``/livez`` answers
        at once, ``/readyz`` once no request would wait for a compiler.

    Raises:
        InvalidRequest: An environment variable has an invalid value, or the store cannot be used.
    """
    settings = settings if settings is not None else load_settings()
    _check_robot_folders()
    app = FastAPI(
        title="ikplan",
        version=ikplan.__version__,
        summary="A tool path in, a certified joint trajectory out.",
        description=(
            "SI units: metres, radians, seconds. Quaternions are (x, y, z, w). Every failure is "
            "an RFC 9457 problem document with the data of one class of error; "
            "[/problems](problems) explains each type."
        ),
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        generate_unique_id_function=openapi.operation_id,
        lifespan=_lifespan,
        # OTEL_EXPORTER_OTLP_ENDPOINT sets the target of traces; Prometheus has the metrics.
        telemetry={"auto_configure": True, "metrics": False, "exclude": is_probe},
    )
    app.state.settings = settings
    planner = planner or ProcessPlanner(
        settings.worker_count,
        settings.max_queued,
        memory_bytes=settings.worker_memory_bytes,
        grace_s=settings.grace_s,
        max_wait_s=settings.max_wait_s,
    )
    app.state.connections = Connections(_connection_limits(settings))
    app.state.metrics = Metrics(planner, app.state.connections)
    app.state.planner = InstrumentedPlanner(planner, app.state.metrics)
    app.state.store, app.state.plan_jobs, uploads = (
        _fleet(settings, app.state.planner)
        if settings.store_url and store is None
        else _alone(settings, app.state.planner, store or _store(settings))
    )
    app.state.metrics.watch_jobs(app.state.plan_jobs)
    app.state.shutdown = Shutdown(app.state.plan_jobs, settings.stop_s)
    app.state.robots = robots or uploads("robots")
    app.state.scenes = scenes or uploads("scenes")
    app.state.described = {}  # robots of the catalogue, each made once by a worker
    app.state.robot_builder = RobotBuilder(settings.robot_memory_bytes, settings.robot_timeout_s)
    for router in ROUTERS:
        app.include_router(router)
    problems.install(app, ROUTERS)
    app.add_exception_handler(StoreFault, _on_store_fault)
    openapi.install(app)
    install_middleware(app, settings, app.state.metrics)
    return app


async def _on_store_fault(request: Request, error: Exception) -> Response:
    """Answer a read or a deletion that the store does not allow now."""
    assert isinstance(error, StoreFault)
    _log.error("the store failed: %s", error)
    return problems.error_response(request, unavailable(error))


def _check_robot_folders() -> None:
    """Read the names of the catalogue now: a folder that is missing is an invalid setting.

    Raises:
        InvalidRequest: ``IKPLAN_ROBOTS_PATH`` names something that is not a folder.
    """
    try:
        robot_names()
    except (InvalidRobot, OSError) as error:
        raise InvalidRequest(str(error), field=PATH_VARIABLE, allowed="folders") from error


def _connection_limits(settings: Settings) -> ConnectionLimits:
    most = most_open(settings.max_connections, settings.worker_count)
    # One address leaves a quarter to the others.
    by_address = min(settings.max_connections_per_address, most - most // 4)
    return ConnectionLimits(
        settings.header_s,
        settings.body_s,
        most=most,
        most_per_address=by_address,
    )


def _store(settings: Settings) -> SqlitePlanStore:
    store = SqlitePlanStore(
        settings.store_path,
        settings.store_plans,
        settings.store_bytes,
        max_age_s=settings.store_days * 86400.0,
        replace_damaged=settings.store_damaged == "set-aside",
    )
    store.check()  # now, so that an invalid setting is reported in one line
    return store


def _upload_bounds(settings: Settings, table: Table) -> tuple[int, int]:
    if table == "robots":
        return settings.store_robots, settings.store_robot_bytes
    return settings.store_scenes, settings.store_scene_bytes


def _alone(settings: Settings, planner: Planner, store: PlanStore) -> Parts:
    """Return the parts of a service that shares its plans and jobs with no other one."""

    def uploads(table: Table) -> DocumentStore:
        bounds = _upload_bounds(settings, table)
        if isinstance(store, SqlitePlanStore):
            return SqliteDocumentStore(store, table, *bounds)
        return MemoryDocumentStore(*bounds)

    return store, PlanJobs(planner, store, settings.max_budget_s, settings.job_quota), uploads


def _fleet(settings: Settings, planner: Planner) -> Parts:
    """Return the parts of one replica of several.

    Raises:
        InvalidRequest: The address is wrong, or what the database needs is not installed.
    """
    try:
        from ikplan_api.jobs.fleet_jobs import FleetJobs
        from ikplan_api.store.postgres.documents import PostgresDocumentStore
        from ikplan_api.store.postgres.store import PostgresBounds, PostgresStore
    except ImportError as error:
        raise InvalidRequest(
            f"IKPLAN_STORE_URL: {error.name} is not installed; pip install 'ikplan[postgres]'",
            field="IKPLAN_STORE_URL",
        ) from error
    bounds = PostgresBounds(
        settings.store_plans,
        settings.store_bytes,
        max_age_s=settings.store_days * 86400.0,
        object_bytes=settings.object_bytes,
    )
    store = PostgresStore(
        settings.store_url, bounds, lease_s=settings.lease_s, object_url=settings.object_store_url
    )
    store.check()
    jobs = FleetJobs(
        planner,
        store,
        settings.max_budget_s,
        lease_s=settings.lease_s,
        max_jobs=settings.max_jobs,
        quota=settings.job_quota,
    )

    def uploads(table: Table) -> DocumentStore:
        return PostgresDocumentStore(store.database, table, *_upload_bounds(settings, table))

    return store, jobs, uploads


@contextlib.asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[dict[str, Any]]:
    for name, near in unknown_variables(os.environ).items():
        hint = f"; did you mean {near[0]}?" if near else ""
        _log.warning("unknown setting %s%s", name, hint)
    shutdown: Shutdown = app.state.shutdown
    planner: Planner = app.state.planner
    store: OpenStore = app.state.store
    await store.open()
    await app.state.plan_jobs.resume()
    warming = asyncio.create_task(planner.warm_up())
    warming.add_done_callback(_report)
    watching = asyncio.create_task(watch_loop(app.state.metrics))
    try:
        # The server calls the first as soon as a shutdown is requested; its protocol keeps to the
        # bounds of the second; the third ends when everything is loaded; the fourth makes in
        # 0.3 s what would hold the loop for the first client that asks for it.
        yield {
            "stop": shutdown.begin,
            "connections": app.state.connections,
            "warming": warming,
            "prepare": app.openapi,
        }
    finally:
        warming.cancel()
        watching.cancel()
        await shutdown.drain()
        await planner.close()
        await app.state.plan_jobs.close()
        await store.close()


def _report(warming: asyncio.Task[None]) -> None:
    """Log why the service could not warm up; it stays unready."""
    if not warming.cancelled() and (error := warming.exception()) is not None:
        _log.error("warming up failed", exc_info=error)
