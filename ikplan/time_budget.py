"""The time budget of a plan, and how long its stages took."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from ikplan.arrays import Flags
from ikplan.errors import BudgetExceeded
from ikplan.processor_time import WALL_FACTOR, has_thread_clocks, thread_clock

__all__ = ["Progress", "SearchCut", "TimeBudget", "ran_out"]

Progress = Callable[[str, int, int], None]
"""Called with a stage's name, and how many of how many waypoints are done; 0 of 0: begun."""


_WATCHED = 20_000
"""Evaluations of the shortest search that a thread watches: they take some 20 ms."""
_SHORTEST_S = 1e-3
"""Shortest wait between two looks at a clock that may run slower than the wall's [s]."""


class SearchCut(Exception):
    """A search was cut short by its clock; an answer would depend on the time, so there is none."""


class TimeBudget:
    """Counts a plan's time and evaluations. It decides whether there is a plan, never which one.

    The budget is one of processor time of the thread that makes it and plans; wall time counts
    by a fourth (:data:`~ikplan.processor_time.WALL_FACTOR`). A machine that has other work to do
    then refuses nothing that it could plan, and every plan ends.

    Args:
        budget_s: The time budget [s].
        progress: Is told how far the plan is; None: nobody is.

    Attributes:
        seconds: How long each stage took, wall time [s].
        evaluations: Forward-kinematics evaluations spent.
    """

    def __init__(self, budget_s: float, progress: Progress | None = None) -> None:
        self.budget_s = budget_s
        self._progress = progress
        self.seconds: dict[str, float] = {}
        self.evaluations = 0
        self._processor = thread_clock()
        self._processor_begin = self._processor()
        self._helped_s = 0.0
        self._begin = time.perf_counter()
        self._stage = ""
        self._since = self._begin
        self._best: Mapping[str, Any] | None = None
        self._waypoints = 0
        self._done = 0

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage, and refuse to begin it when the budget has run out.

        A stage may run within another: its time does not count for the outer one, so that the
        seconds of all stages add up to the time spent, and the count of waypoints goes on.

        Raises:
            BudgetExceeded: The budget ran out before the stage, or a search in it was cut short.
        """
        outer = self._stage
        if outer:
            self.check()  # what has run out, has run out in the outer stage
            self._stage = name
        else:
            self._stage = name
            self.check()
            self._waypoints = self._done = 0
        self.report(self._done)
        self._book(outer)
        try:
            yield
        except SearchCut as short:
            raise self._exceeded() from short
        finally:
            self._book(name)
            self._stage = outer
        if outer:
            self.report(self._done)

    def _book(self, stage: str) -> None:
        """Count the time since the last change of stages for a stage; "": for none."""
        now = time.perf_counter()
        if stage:
            self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._since
        self._since = now

    def count(self, evaluations: int) -> None:
        """Count forward-kinematics evaluations that were spent."""
        self.evaluations += int(evaluations)

    def spend(self, processor_s: float) -> None:
        """Count processor time of other threads that this one waits for.

        Args:
            processor_s: Their mean, no more than the wall time of the wait [s].
        """
        if has_thread_clocks():  # else the wait itself counts
            self._helped_s += processor_s

    def set_total(self, waypoints: int) -> None:
        """Tell how many waypoints there are to do."""
        self._waypoints = waypoints
        self.report(0)

    def report(self, done: int) -> None:
        """Tell how many waypoints are done."""
        self._done = done
        if self._progress is not None:
            self._progress(self._stage, done, self._waypoints)

    def _wall_s(self) -> float:
        """Wall time spent [s]."""
        return time.perf_counter() - self._begin

    def _processor_s(self) -> float:
        """Processor time spent by the plan's thread, and by others that it waited for [s]."""
        return self._processor() - self._processor_begin + self._helped_s

    @property
    def left(self) -> float:
        """Time left of the budget [s]; none passes faster than wall time."""
        return self.budget_s - max(self._processor_s(), self._wall_s() / WALL_FACTOR)

    def check(self, best: Mapping[str, Any] | None = None) -> None:
        """Raise BudgetExceeded, with the best known so far, when the budget has run out."""
        self._best = best or self._best
        if time.perf_counter() - self._begin <= self.budget_s:
            return  # no clock that counts is ahead of this one
        wall_s = self._wall_s()
        # A thread's processor time is no longer than that: most looks need one clock only.
        if wall_s <= self.budget_s:
            return
        if wall_s > WALL_FACTOR * self.budget_s or self._processor_s() > self.budget_s:
            raise self._exceeded()

    @contextmanager
    def cutting(self, cut: Flags, evaluations: int) -> Iterator[None]:
        """End long searches when the budget has run out.

        Args:
            cut: Shape (1,): the flag that searches look at.
            evaluations: How long one search is; short ones are not worth a thread that watches
                them: the clock is looked at between them.

        Raises:
            BudgetExceeded: A search was cut short; with the last best that was known.
        """
        if evaluations < _WATCHED:
            yield
            return
        watch = _Watch(cut, self)
        wait_s = min(max(self.left, 0.0), threading.TIMEOUT_MAX)
        timer = threading.Timer(wait_s, watch.look)
        timer.daemon = True
        timer.start()
        try:
            yield
        except SearchCut as short:
            raise self._exceeded() from short
        finally:
            watch.over.set()
            timer.cancel()

    def _exceeded(self) -> BudgetExceeded:
        by_processor = self._processor_s() >= self.budget_s
        return BudgetExceeded(
            f"{ran_out(self.budget_s, self._stage, by_processor=by_processor)}; "
            "a larger budget_s, fewer waypoints or a faster ik.method would help",
            stage=self._stage,
            budget_s=self.budget_s,
            best=self._best,
        )


class _Watch:
    """Sets the flag of a search when the budget has run out, unless the search is over."""

    def __init__(self, cut: Flags, budget: TimeBudget) -> None:
        self._cut, self._budget = cut, budget
        self.over = threading.Event()

    def look(self) -> None:
        """Set the flag as soon as no time is left, which may be later than it seemed."""
        try:
            while (left := self._budget.left) > 0.0:
                if self.over.wait(min(max(left, _SHORTEST_S), threading.TIMEOUT_MAX)):
                    return
        except OSError:  # the thread of the plan has ended, and its clock
            return
        if not self.over.is_set():
            self._cut.fill(True)


def ran_out(budget_s: float, stage: str, *, by_processor: bool) -> str:
    """Return the words for a budget [s] that ran out: in which stage, and by which clock."""
    if by_processor:
        return f"the budget of {budget_s:g} s of processor time ran out in the stage {stage!r}"
    return (
        f"the budget of {budget_s:g} s ran out in the stage {stage!r}: on a busy machine "
        f"{WALL_FACTOR:g} times as much wall time passed"
    )
