"""Who does the work: the event loop never plans."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ikplan.planning import Progress
from ikplan_api.tasks import Answer

__all__ = ["Load", "Planner"]


class Load(NamedTuple):
    """What the workers have to do.

    Attributes:
        workers: How many there are.
        running: Tasks being done.
        queued: Tasks that wait for a worker.
    """

    workers: int
    running: int
    queued: int


class Planner(Protocol):
    """Runs tasks off the event loop."""

    @property
    def ready(self) -> bool:
        """Whether a request would be answered without waiting for a compiler."""

    @property
    def load(self) -> Load:
        """What the workers have to do."""

    def check_room(self) -> None:
        """Do nothing where one more task may wait.

        Raises:
            ServiceUnavailable: No room in the queue.
        """

    async def run(
        self,
        kind: str,
        document: bytes,
        *,
        robot: bytes | None = None,
        limit_s: float = ...,
        progress: Progress | None = None,
        patient: bool = False,
    ) -> Answer:
        """Do one task of :data:`ikplan_api.tasks.TASKS`; cancelling it stops the work.

        Args:
            kind: Name of the task.
            document: The request document.
            robot: Description of an uploaded robot that the request names; None: the
                catalogue's.
            limit_s: Longest time that the task may take once it is begun [s].
            progress: Is told how far the task is.
            patient: Wait for room in the queue, however long that takes, instead of being refused.

        Raises:
            IkplanError: The verdict on the request.
            BudgetExceeded: The task took longer than ``limit_s``.
            MemoryExceeded: The task needed more memory than a worker may take.
            WorkerLost: The worker ended in the middle of the task.
            ServiceUnavailable: No room in the queue.
        """

    async def warm_up(self) -> None:
        """Get ready; returns when ``ready`` is true, or raises why it is not."""

    async def close(self) -> None:
        """Stop, and whatever is being done with it."""
