"""How often a task is tried whose worker process ends."""

from __future__ import annotations

import logging
import signal
from collections.abc import Awaitable, Callable
from typing import TypeVar

from ikplan.errors import IkplanError, ServiceUnavailable, WorkerLost

__all__ = ["ATTEMPTS", "Attempts"]

_log = logging.getLogger("ikplan.service")

ATTEMPTS = 2
"""Attempts of a task whose worker ends."""
_FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Signals that another process or the system sends; code that crashes ends by others."""
_RETRY_AFTER_S = 1.0

T = TypeVar("T")


class Attempts:
    """The attempts of one task.

    Args:
        begun: Attempts before this one.

    Attributes:
        begun: Attempts that a worker has begun, those before included.
    """

    def __init__(self, begun: int = 0) -> None:
        self.begun = begun

    def begin(self) -> None:
        """Count an attempt: a worker begins the task."""
        self.begun += 1

    def withdraw(self) -> None:
        """Take back the latest attempt: its worker did not begin the task, or was not to end it."""
        self.begun -= 1

    def verdict(self, lost: WorkerLost) -> IkplanError:
        """Return the answer to a caller after the last attempt.

        A request that crashes its workers gets :class:`WorkerLost`. Where the workers were ended
        from outside the request may succeed later, and gets :class:`ServiceUnavailable`.
        """
        if -lost.exit_code not in _FROM_OUTSIDE:
            return self.lost(lost)
        return ServiceUnavailable(
            f"{lost.detail}; the request was tried {self.begun} times; try again",
            status_code=ServiceUnavailable.status,
            retry_after_s=_RETRY_AFTER_S,
        )

    def lost(self, lost: WorkerLost) -> WorkerLost:
        """Return the error of a task that is not tried again."""
        detail = f"{lost.detail}; the request was tried {self.begun} times"
        return WorkerLost(detail, exit_code=lost.exit_code)

    async def run(self, attempt: Callable[[], Awaitable[T]]) -> T:
        """Run a task until an attempt is not ended by the end of its worker.

        Args:
            attempt: Runs the task once, and calls :meth:`begin` when a worker begins it.

        Raises:
            WorkerLost: Each attempt crashed its worker.
            ServiceUnavailable: The last worker was ended from outside.
        """
        while True:
            try:
                return await attempt()
            except WorkerLost as error:
                if self.begun >= ATTEMPTS:
                    raise self.verdict(error) from error
                _log.warning("%s: attempt %d of %d failed", error, self.begun, ATTEMPTS)
