"""Interface of a planner, which runs tasks outside of the event loop."""

from __future__ import annotations

from typing import Protocol

from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan.planning import Progress
from ikplan_api.telemetry.load import LoadSource
from ikplan_api.workers.attempts import Attempts
from ikplan_api.workers.tasks import TaskResult

__all__ = ["Planner"]


class Planner(LoadSource, Protocol):
    """Runs tasks off the event loop."""

    def check_capacity(self) -> None:
        """Raise if the queue is full.

        Raises:
            ServiceUnavailable: The queue is full.
        """

    async def run(
        self,
        kind: str,
        document: bytes,
        *,
        robot: bytes | None = None,
        known: KnownRequest = UNKNOWN,
        limit_s: float = ...,
        progress: Progress | None = None,
        wait_if_full: bool = False,
        attempts: Attempts | None = None,
    ) -> TaskResult:
        """Run one task of :data:`ikplan_api.workers.tasks.TASKS`; cancellation stops it.

        Args:
            kind: Name of the task.
            document: The request document.
            robot: The uploaded robot that the request names; None: a robot of the catalogue.
            known: What is known of the request already.
            limit_s: Limit of its processor time from the start of the task [s]; its wall time is
                limited to :data:`~ikplan.processor_time.WALL_FACTOR` times as much.
            progress: Receives the progress of the task.
            wait_if_full: If the queue is full, wait instead of raising.
            attempts: Counts the attempts; None: there are none before.

        Raises:
            IkplanError: The verdict on the request.
            BudgetExceeded: The task took longer than ``limit_s``.
            MemoryExceeded: The task needed more memory than a worker may allocate.
            WorkerLost: Each of the attempts crashed its worker process.
            ServiceUnavailable: The queue is full, or worker processes were ended from outside.
        """

    async def warm_up(self) -> None:
        """Start up; return when ``ready`` is true, or raise the failure."""

    async def close(self) -> None:
        """Stop and cancel every task."""
