"""Load of the worker processes, as metrics show it."""

from __future__ import annotations

from typing import NamedTuple, Protocol

__all__ = ["Load", "LoadSource"]


class Load(NamedTuple):
    """How busy the workers are.

    Attributes:
        workers: Number of worker processes.
        running: Tasks that a worker runs now.
        queued: Tasks that wait for a worker.
    """

    workers: int
    running: int
    queued: int


class LoadSource(Protocol):
    """Anything that knows the state of the workers: every planner."""

    @property
    def ready(self) -> bool:
        """Whether every kernel is compiled, so that no request waits for a compiler."""

    @property
    def load(self) -> Load:
        """Current load of the workers."""
