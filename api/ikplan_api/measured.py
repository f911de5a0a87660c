"""A planner whose work is counted, timed and traced."""

from __future__ import annotations

import asyncio
import time

from opentelemetry import trace

import ikplan
from ikplan.errors import IkplanError
from ikplan.planning import Progress
from ikplan_api.metrics import Metrics
from ikplan_api.planner import Load, Planner
from ikplan_api.pool import LIMIT_S
from ikplan_api.tasks import Answer

__all__ = ["MeasuredPlanner"]

# Spans are dropped unless OpenTelemetry's SDK is installed and told where they go.
_tracer = trace.get_tracer("ikplan.service", ikplan.__version__)


class MeasuredPlanner:
    """Lets another planner do the work, and tells what becomes of it.

    Args:
        planner: Who does the work.
        metrics: Where it is told.
    """

    def __init__(self, planner: Planner, metrics: Metrics) -> None:
        self._planner = planner
        self._metrics = metrics

    @property
    def ready(self) -> bool:
        """Whether a request would be answered without waiting for a compiler."""
        return self._planner.ready

    @property
    def load(self) -> Load:
        """What the workers have to do."""
        return self._planner.load

    async def run(
        self,
        kind: str,
        document: bytes,
        *,
        robot: bytes | None = None,
        limit_s: float = LIMIT_S,
        progress: Progress | None = None,
        patient: bool = False,
    ) -> Answer:
        """Do one task; see :meth:`ikplan_api.planner.Planner.run`."""
        began, outcome = time.perf_counter(), "fault"
        with _tracer.start_as_current_span(f"ikplan {kind}") as span:
            try:
                answer = await self._planner.run(
                    kind,
                    document,
                    robot=robot,
                    limit_s=limit_s,
                    progress=progress,
                    patient=patient,
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
            if answer.facts is not None:
                self._metrics.made(answer.facts)
                for stage, seconds in answer.facts.stages.items():
                    span.set_attribute(f"ikplan.stage.{stage}.seconds", seconds)
        return answer

    def check_room(self) -> None:
        """Do nothing where one more task may wait; see :class:`~ikplan_api.planner.Planner`."""
        self._planner.check_room()

    async def warm_up(self) -> None:
        """Get ready; returns when ``ready`` is true, or raises why it is not."""
        await self._planner.warm_up()

    async def close(self) -> None:
        """Stop, and whatever is being done with it."""
        await self._planner.close()
