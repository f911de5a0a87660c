"""A planner that records metrics and traces of every task."""

from __future__ import annotations

import asyncio
import time

from opentelemetry import trace

import ikplan
from ikplan.errors import IkplanError
from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan.planning import Progress
from ikplan_api.telemetry.load import Load
from ikplan_api.telemetry.metrics import Metrics
from ikplan_api.workers.attempts import Attempts
from ikplan_api.workers.planner import Planner
from ikplan_api.workers.process_planner import LIMIT_S
from ikplan_api.workers.tasks import TaskResult

__all__ = ["InstrumentedPlanner"]

# Without a configured OpenTelemetry SDK, spans are dropped.
_tracer = trace.get_tracer("ikplan.service", ikplan.__version__)


class InstrumentedPlanner:
    """Runs tasks by another planner and records their outcome.

    Args:
        planner: The planner that runs the tasks.
        metrics: The metrics to update.
    """

    def __init__(self, planner: Planner, metrics: Metrics) -> None:
        self._planner = planner
        self._metrics = metrics

    @property
    def ready(self) -> bool:
        """Whether every kernel is compiled, so that no request waits for a compiler."""
        return self._planner.ready

    @property
    def load(self) -> Load:
        """Current load of the workers."""
        return self._planner.load

    async def run(
        self,
        kind: str,
        document: bytes,
        *,
        robot: bytes | None = None,
        known: KnownRequest = UNKNOWN,
        limit_s: float = LIMIT_S,
        progress: Progress | None = None,
        wait_if_full: bool = False,
        attempts: Attempts | None = None,
    ) -> TaskResult:
        """Run one task; see :meth:`ikplan_api.workers.planner.Planner.run`."""
        began, outcome = time.perf_counter(), "fault"
        with _tracer.start_as_current_span(f"ikplan {kind}") as span:
            try:
                answer = await self._planner.run(
                    kind,
                    document,
                    robot=robot,
                    known=known,
                    limit_s=limit_s,
                    progress=progress,
                    wait_if_full=wait_if_full,
                    attempts=attempts,
                )
                outcome = "done"
            except IkplanError as error:
                outcome = error.slug
                raise
            except asyncio.CancelledError:
                outcome = "cancelled"
                raise
            finally:
                span.set_attribute("ikplan.outcome", outcome)
                self._metrics.outcomes.labels(kind, outcome).inc()
                self._metrics.tasks.labels(kind).observe(time.perf_counter() - began)
            if answer.figures is not None:
                self._metrics.count_plan(answer.figures)
                for stage, seconds in answer.figures.stages.items():
                    span.set_attribute(f"ikplan.stage.{stage}.seconds", seconds)
        return answer

    def check_capacity(self) -> None:
        """Raise if the queue is full; see :class:`~ikplan_api.workers.planner.Planner`."""
        self._planner.check_capacity()

    async def warm_up(self) -> None:
        """Start up; return when ``ready`` is true, or raise the failure."""
        await self._planner.warm_up()

    async def close(self) -> None:
        """Stop and cancel every task."""
        await self._planner.close()
