"""Prometheus metrics of the running service."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    GCCollector,
    Histogram,
    Info,
    PlatformCollector,
    ProcessCollector,
)
from prometheus_client.core import CounterMetricFamily
from prometheus_client.exposition import CONTENT_TYPE_LATEST, generate_latest
from prometheus_client.registry import Collector

import ikplan
from ikplan_api.telemetry.load import ConnectionSource, JobSource, LoadSource
from ikplan_api.telemetry.plan_figures import PlanFigures

__all__ = ["MEDIA_TYPE", "Metrics"]

MEDIA_TYPE = CONTENT_TYPE_LATEST
_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60)
_MARGINS = (0.0, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0)
_COUNTS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 10_000, 100_000)


class _ClosedConnections(Collector):
    """Connections that the service closed, by reason."""

    def __init__(self, connections: ConnectionSource) -> None:
        self._connections = connections

    def collect(self) -> Iterator[CounterMetricFamily]:
        family = CounterMetricFamily(
            "ikplan_connections_closed",
            "Connections closed by the service: slow clients, or too many connections",
            labels=["reason"],
        )
        for reason, count in sorted(self._connections.closed.items()):
            family.add_metric([reason], count)
        yield family


class _EndedJobs(Collector):
    """Jobs that ended in this process, by how."""

    def __init__(self, jobs: JobSource) -> None:
        self._jobs = jobs

    def collect(self) -> Iterator[CounterMetricFamily]:
        family = CounterMetricFamily(
            "ikplan_jobs_ended",
            "Jobs that ended here: finished, failed, or late (their claim was lost before)",
            labels=["end"],
        )
        for end, count in sorted(self._jobs.ends.items()):
            family.add_metric([end], count)
        yield family


class Metrics:
    """Every metric of the service, in a registry of its own.

    Args:
        planner: The source of readiness and load.
        connections: The source of the number of connections.
    """

    def __init__(self, planner: LoadSource, connections: ConnectionSource) -> None:
        registry = self._registry = CollectorRegistry()
        registry.register(_ClosedConnections(connections))
        for collector in (ProcessCollector, PlatformCollector, GCCollector):
            collector(registry=registry)
        version = Info("ikplan", "Version of the running service", registry=registry)
        version.info({"version": ikplan.__version__})
        self.requests = Histogram(
            "ikplan_http_request_seconds",
            "Time from receiving a request to the end of its response",
            ["method", "route", "status"],
            buckets=_SECONDS,
            registry=registry,
        )
        self.in_flight = Gauge(
            "ikplan_http_requests_in_flight", "Requests in progress", registry=registry
        )
        self.loop_lag = Histogram(
            "ikplan_event_loop_lag_seconds",
            "Time that the event loop keeps a ready task waiting",
            buckets=_SECONDS,
            registry=registry,
        )
        self.tasks = Histogram(
            "ikplan_task_seconds",
            "Time to run a task, including the wait for a worker",
            ["kind"],
            buckets=_SECONDS,
            registry=registry,
        )
        self.outcomes = Counter(
            "ikplan_tasks",
            "Tasks by outcome: done, cancelled, fault, or the type of the problem",
            ["kind", "outcome"],
            registry=registry,
        )
        self._stages = Histogram(
            "ikplan_stage_seconds",
            "Duration of each planning stage",
            ["stage"],
            buckets=_SECONDS,
            registry=registry,
        )
        self._margins = Histogram(
            "ikplan_certificate_margin",
            "Share of a limit that a certified plan leaves unused",
            ["limit"],
            buckets=_MARGINS,
            registry=registry,
        )
        self._waypoints = Histogram(
            "ikplan_plan_waypoints", "Waypoints of a plan", buckets=_COUNTS, registry=registry
        )
        self._samples = Histogram(
            "ikplan_plan_samples", "Timed samples of a plan", buckets=_COUNTS, registry=registry
        )
        gauges: dict[str, tuple[str, Callable[[], float]]] = {
            "ikplan_expected_wait_seconds": (
                "Expected time that a further task waits for a worker",
                lambda: planner.load.wait_s,
            ),
            "ikplan_connections": ("Open connections", lambda: len(connections)),
            "ikplan_ready": ("1 if the workers are warm, else 0", lambda: planner.ready),
            "ikplan_workers": ("Worker processes", lambda: planner.load.workers),
            "ikplan_tasks_running": ("Tasks that a worker runs now", lambda: planner.load.running),
            "ikplan_tasks_queued": ("Tasks that wait for a worker", lambda: planner.load.queued),
        }
        for name, (title, ask) in gauges.items():
            Gauge(name, title, registry=registry).set_function(ask)

    def watch_jobs(self, jobs: JobSource) -> None:
        """Show the queue of jobs, which is that of all replicas where they share one."""
        gauges: dict[str, tuple[str, Callable[[], float]]] = {
            "ikplan_jobs_queued": (
                "Jobs that wait for a worker, of all replicas",
                lambda: jobs.depth[0],
            ),
            "ikplan_jobs_running": (
                "Jobs that a worker runs, of all replicas",
                lambda: jobs.depth[1],
            ),
            "ikplan_store_up": ("1 if the store answers, else 0", lambda: jobs.store_up),
        }
        for name, (title, ask) in gauges.items():
            Gauge(name, title, registry=self._registry).set_function(ask)
        self._registry.register(_EndedJobs(jobs))

    def count_plan(self, figures: PlanFigures) -> None:
        """Record the figures of one plan."""
        for stage, seconds in figures.stages.items():
            self._stages.labels(stage).observe(seconds)
        for limit, margin in figures.margins.items():
            self._margins.labels(limit).observe(margin)
        self._waypoints.observe(figures.waypoints)
        self._samples.observe(figures.samples)

    def text(self) -> bytes:
        """Return all metrics in the Prometheus text format."""
        return generate_latest(self._registry)
