"""The time budget of a request: compiling and loading kernels is no part of it."""

from __future__ import annotations

from ikplan._kernels.clock import kernel_seconds, thread_kernels
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
        super().__init__(budget_s, progress)
        self._before = self._booked = kernel_seconds()
        self._kernels = thread_kernels()
        self._processor_before = self._kernels.seconds(self._processor)

    def _wall_s(self) -> float:
        return super()._wall_s() - (kernel_seconds() - self._before)

    def _processor_s(self) -> float:
        # In this order: between two looks at a kernel that is compiled, no time seems spent.
        spent_s = super()._processor_s()
        return spent_s - (self._kernels.seconds(self._processor) - self._processor_before)

    def _book(self, stage: str) -> None:
        passed = kernel_seconds()
        self._since += passed - self._booked
        self._booked = passed
        super()._book(stage)
