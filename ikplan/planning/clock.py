"""The time budget of a plan, and how long its stages took."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from ikplan.errors import BudgetExceeded

__all__ = ["Clock"]


class Clock:
    """Counts a plan's time. It decides whether there is a plan, never which one.

    Args:
        budget_s: The time budget [s].
    """

    def __init__(self, budget_s: float) -> None:
        self.budget_s = budget_s
        self.seconds: dict[str, float] = {}
        self._begin = time.perf_counter()
        self._stage = ""

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage, and refuse to begin it when the budget has run out.

        Raises:
            BudgetExceeded: The budget ran out before the stage.
        """
        self._stage = name
        self.check()
        begin = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin

    @property
    def left(self) -> float:
        """Time left of the budget [s]."""
        return self.budget_s - (time.perf_counter() - self._begin)

    def check(self, best: Mapping[str, Any] | None = None) -> None:
        """Raise BudgetExceeded, with the best so far, when the budget has run out."""
        if self.left < 0.0:
            raise BudgetExceeded(
                f"the budget of {self.budget_s:g} s ran out in the stage {self._stage!r}; "
                "a larger budget_s, fewer waypoints or a faster ik.method would help",
                stage=self._stage,
                budget_s=self.budget_s,
                best=best,
            )
