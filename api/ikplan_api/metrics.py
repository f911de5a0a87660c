"""Figures of the running service, for Prometheus."""

from __future__ import annotations

from collections.abc import Callable

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
from prometheus_client.exposition import CONTENT_TYPE_LATEST, generate_latest

import ikplan
from ikplan_api.facts import PlanFacts
from ikplan_api.planner import Planner

__all__ = ["MEDIA_TYPE", "Metrics"]

MEDIA_TYPE = CONTENT_TYPE_LATEST
_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60)
_MARGINS = (0.0, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0)
_COUNTS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 10_000, 100_000)


class Metrics:
    """What is counted and timed, in a registry of its own.

    Args:
        planner: Whose load is told.
    """

    def __init__(self, planner: Planner) -> None:
        registry = self._registry = CollectorRegistry()
        for collector in (ProcessCollector, PlatformCollector, GCCollector):
            collector(registry=registry)
        Info("ikplan", "What runs here", registry=registry).info({"version": ikplan.__version__})
        self.requests = Histogram(
            "ikplan_http_request_seconds",
            "Time from a request to the end of its answer",
            ["method", "route", "status"],
            buckets=_SECONDS,
            registry=registry,
        )
        self.in_flight = Gauge(
            "ikplan_http_requests_in_flight", "Requests being answered", registry=registry
        )
        self.tasks = Histogram(
            "ikplan_task_seconds",
            "Time from asking the workers to their answer, waiting included",
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
            "Time that a stage of a plan took",
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
            "ikplan_ready": ("Whether the workers are warm", lambda: planner.ready),
            "ikplan_workers": ("Worker processes", lambda: planner.load.workers),
            "ikplan_tasks_running": ("Tasks being done", lambda: planner.load.running),
            "ikplan_tasks_queued": ("Tasks that wait", lambda: planner.load.queued),
        }
        for name, (title, ask) in gauges.items():
            Gauge(name, title, registry=registry).set_function(ask)

    def made(self, facts: PlanFacts) -> None:
        """Count a plan."""
        for stage, seconds in facts.stages.items():
            self._stages.labels(stage).observe(seconds)
        for limit, margin in facts.margins.items():
            self._margins.labels(limit).observe(margin)
        self._waypoints.observe(facts.waypoints)
        self._samples.observe(facts.samples)

    def text(self) -> bytes:
        """Return all of it as Prometheus reads it."""
        return generate_latest(self._registry)
