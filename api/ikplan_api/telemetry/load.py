"""Load of the worker processes, as metrics show it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, Protocol

__all__ = ["ConnectionSource", "JobSource", "Load", "LoadSource"]


class Load(NamedTuple):
    """How busy the workers are.

    Attributes:
        workers: Number of worker processes.
        running: Tasks that a worker runs now.
        queued: Tasks that wait for a worker.
        wait_s: Expected time that a further task waits for a worker [s].
    """

    workers: int
    running: int
    queued: int
    wait_s: float = 0.0


class LoadSource(Protocol):
    """Anything that knows the state of the workers: every planner."""

    @property
    def ready(self) -> bool:
        """Whether every kernel is compiled, so that no request waits for a compiler."""

    @property
    def load(self) -> Load:
        """Current load of the workers."""


class JobSource(Protocol):
    """Anything that knows the jobs."""

    @property
    def depth(self) -> tuple[int, int]:
        """Number of jobs that wait for a worker, and of those that run."""

    @property
    def ends(self) -> Mapping[str, int]:
        """Number of jobs that ended here, by how."""

    @property
    def store_up(self) -> bool:
        """Whether the store answered when it was last asked."""


class ConnectionSource(Protocol):
    """Anything that knows the open connections."""

    @property
    def closed(self) -> Mapping[str, int]:
        """Number of connections closed by the service, by reason."""

    def __len__(self) -> int:
        """Return the number of open connections."""
