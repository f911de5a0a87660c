"""What a job needs of its client: to send a call, and to watch a plan."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from typing import Protocol, TypeVar

from ikplan.client.wire import Call
from ikplan.documents.status import PlanStatus
from ikplan.errors import IkplanError

__all__ = ["AsyncConnection", "Connection"]

T = TypeVar("T")


class Connection(Protocol):
    """A client that waits."""

    def _send(self, call: Call[T]) -> T:
        """Send a call and return its answer."""
        ...

    def _watch(self, plan_id: str, left_s: float) -> Iterator[PlanStatus | IkplanError]:
        """Yield what the service tells of a plan, for at most a time [s]."""
        ...


class AsyncConnection(Protocol):
    """A client that is awaited."""

    async def _send(self, call: Call[T]) -> T:
        """Send a call and return its answer."""
        ...

    def _watch(self, plan_id: str, left_s: float) -> AsyncIterator[PlanStatus | IkplanError]:
        """Yield what the service tells of a plan, for at most a time [s]."""
        ...
