"""The time budget of a request: compiling and loading kernels is no part of it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

from ikplan._kernels.clock import kernel_seconds
from ikplan.arrays import Flags
from ikplan.time_budget import Progress, TimeBudget

__all__ = ["RequestBudget"]


class RequestBudget(TimeBudget):
    """A time budget that stands still while kernels are compiled or loaded.

    On the first use after an installation that takes longer than any request.

    Args:
        budget_s: The time budget [s].
        progress: Is told how far the plan is; None: nobody is.
    """

    def __init__(self, budget_s: float, progress: Progress | None = None) -> None:
        self._before = self._booked = kernel_seconds()
        super().__init__(budget_s, progress)

    @property
    def left(self) -> float:
        """Time left of the budget [s]."""
        return super().left + kernel_seconds() - self._before

    def _book(self, stage: str) -> None:
        passed = kernel_seconds()
        self._since += passed - self._booked
        self._booked = passed
        super()._book(stage)

    @contextmanager
    def cutting(self, cut: Flags, evaluations: int) -> Iterator[None]:
        """End long searches when the budget has run out; see :class:`TimeBudget`."""
        waiting = _Waiting(cut, self)
        try:
            with super().cutting(cast(Flags, waiting), evaluations):
                yield
        finally:
            waiting.over.set()


class _Waiting:
    """Sets a flag when the budget has run out, which may be later than it seemed."""

    def __init__(self, cut: Flags, budget: RequestBudget) -> None:
        self._cut, self._budget = cut, budget
        self.over = threading.Event()

    def fill(self, value: bool) -> None:
        """Set the flag as soon as no time is left, unless the search is over."""
        while (left := self._budget.left) > 0.0:
            if self.over.wait(min(left, threading.TIMEOUT_MAX)):
                return
        if not self.over.is_set():
            self._cut.fill(value)
