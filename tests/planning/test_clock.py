"""The clock of a plan: what is left, what was best, and how it ends long searches.

Time is made up, but where the clock itself is tested.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from typing import ClassVar

import numpy as np
import pytest

from ikplan import BudgetExceeded
from ikplan.planning import TimeBudget
from ikplan.processor_time import WALL_FACTOR, thread_clock
from ikplan.time_budget import SearchCut

from .conftest import Time


def test_what_is_left_is_the_budget_less_the_time_passed(passing: Time) -> None:
    passing.now = 100.0
    clock = TimeBudget(10.0)
    assert clock.left == 10.0
    passing.now = 107.5
    assert clock.left == 2.5
    clock.check()
    passing.now = 110.0
    clock.check()
    passing.now = 110.1
    with pytest.raises(BudgetExceeded):
        clock.check()


def test_only_processor_time_of_the_thread_and_a_fourth_of_wall_time_count(passing: Time) -> None:
    clock = TimeBudget(10.0)
    passing.now, passing.idle = 12.0, 5.0
    assert clock.left == 3.0
    passing.now, passing.idle = 36.0, 30.0
    assert clock.left == 1.0
    clock.check()


def run_out(clock: TimeBudget) -> str:
    with pytest.raises(BudgetExceeded) as caught, clock.stage("ik"):
        pytest.fail("a stage is not begun after the budget")
    return caught.value.detail


def test_processor_time_ends_a_plan_as_soon_as_the_budget_is_gone(passing: Time) -> None:
    clock = TimeBudget(10.0)
    passing.now, passing.idle = 30.0, 20.0
    clock.check()
    passing.now += 0.1
    assert "10 s of processor time" in run_out(clock)


def test_wall_time_ends_a_plan_at_four_times_the_budget(passing: Time) -> None:
    clock = TimeBudget(10.0)
    passing.now, passing.idle = 40.0, 39.0
    clock.check()
    passing.now = 40.1
    assert "4 times as much wall time" in run_out(clock)


def test_without_a_clock_of_the_thread_wall_time_is_the_budget(
    passing: Time, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(time, "pthread_getcpuclockid")
    clock = TimeBudget(10.0)
    passing.now, passing.idle = 10.0, 9.0
    assert clock.left == 0.0
    passing.now = 10.1
    run_out(clock)


def test_the_clock_of_a_thread_counts_its_work_only_whoever_reads_it() -> None:
    clock = thread_clock()
    begin = time.thread_time()
    between, end = clock(), time.thread_time()
    assert begin <= between <= end

    def work() -> None:
        until = time.thread_time() + 0.05
        while time.thread_time() < until:
            pass
        read.append(clock())

    read: list[float] = []
    thread = threading.Thread(target=work)
    before = clock()
    thread.start()
    thread.join()
    assert before <= read[0] < before + 0.05


def test_the_error_names_the_stage_that_runs_and_carries_the_last_best(
    passing: Time,
) -> None:
    clock = TimeBudget(10.0)
    with clock.stage("ik"):
        clock.check({"waypoints_solved": 1})
        clock.check()
        clock.check({"waypoints_solved": 3})
        passing.now = 10.5
        with pytest.raises(BudgetExceeded) as caught:
            clock.check()
    error = caught.value
    assert (error.stage, error.budget_s) == ("ik", 10.0)
    assert error.best == {"waypoints_solved": 3}
    assert "10 s" in error.detail
    assert "'ik'" in error.detail


def test_without_a_best_so_far_the_error_carries_none(passing: Time) -> None:
    clock = TimeBudget(1.0)
    passing.now = 2.0
    with pytest.raises(BudgetExceeded) as caught, clock.stage("ik"):
        pytest.fail("a stage is not begun after the budget")
    assert caught.value.best is None
    assert caught.value.stage == "ik"


def test_a_best_that_comes_too_late_counts_all_the_same(passing: Time) -> None:
    clock = TimeBudget(1.0)
    with clock.stage("ik"):
        passing.now = 2.0
        with pytest.raises(BudgetExceeded) as caught:
            clock.check({"waypoints_solved": 5})
    assert caught.value.best == {"waypoints_solved": 5}


def test_the_time_of_each_stage_is_added_up_also_of_one_that_fails(passing: Time) -> None:
    clock = TimeBudget(100.0)
    for stage, seconds in (("ik", 2.0), ("timing", 3.0), ("ik", 4.0)):
        with clock.stage(stage):
            passing.now += seconds
    with contextlib.suppress(ZeroDivisionError), clock.stage("timing"):
        passing.now += 0.5
        raise ZeroDivisionError
    assert clock.seconds == {"ik": 6.0, "timing": 3.5}


def test_the_time_of_a_stage_within_another_counts_once(passing: Time) -> None:
    clock = TimeBudget(100.0)
    with clock.stage("planning"):
        passing.now += 1.0
        for _ in range(2):
            with clock.stage("ik"):
                passing.now += 3.0
            passing.now += 5.0
        with contextlib.suppress(ZeroDivisionError), clock.stage("ik"):
            passing.now += 0.5
            raise ZeroDivisionError
        passing.now += 0.25
    passing.now += 7.0  # between two stages
    with clock.stage("timing"):
        passing.now += 2.0
    assert clock.seconds == {"planning": 11.25, "ik": 6.5, "timing": 2.0}


def test_the_error_names_the_innermost_stage_that_runs(passing: Time) -> None:
    def left(where: str) -> BudgetExceeded:
        passing.now = 0.0
        clock = TimeBudget(10.0)

        def look(here: str) -> None:
            if here == where:
                passing.now = 11.0
            clock.check()

        def plan() -> None:
            with clock.stage("planning"):
                look("before")
                with clock.stage("ik"):
                    look("within")
                look("after")

        with pytest.raises(BudgetExceeded) as caught:
            plan()
        return caught.value

    stages = {where: left(where).stage for where in ("before", "within", "after")}
    assert stages == {"before": "planning", "within": "ik", "after": "planning"}


def test_a_stage_within_another_that_is_refused_ran_out_in_the_outer_one(passing: Time) -> None:
    clock = TimeBudget(10.0)

    def plan() -> None:
        with clock.stage("planning"):
            passing.now = 11.0
            with clock.stage("ik"):
                pytest.fail("a stage is not begun after the budget")

    with pytest.raises(BudgetExceeded) as caught:
        plan()
    assert caught.value.stage == "planning"


def test_progress_goes_on_counting_through_a_stage_within_another() -> None:
    told: list[tuple[str, int, int]] = []
    clock = TimeBudget(10.0, lambda *what: told.append(what))
    with clock.stage("planning"):
        clock.set_total(3)
        clock.report(1)
        with clock.stage("ik"):
            clock.report(2)
        clock.report(3)
    assert told == [
        ("planning", 0, 0),
        ("planning", 0, 3),
        ("planning", 1, 3),
        ("ik", 1, 3),
        ("ik", 2, 3),
        ("planning", 2, 3),
        ("planning", 3, 3),
    ]


def test_progress_names_the_stage_and_counts_its_waypoints(passing: Time) -> None:
    told: list[tuple[str, int, int]] = []
    clock = TimeBudget(10.0, lambda *what: told.append(what))
    with clock.stage("ik"):
        clock.set_total(3)
        for k in range(4):
            clock.report(k)
    with clock.stage("timing"):
        passing.now = 1.0
    counted = [("ik", k, 3) for k in (0, 0, 1, 2, 3)]
    assert told == [("ik", 0, 0), *counted, ("timing", 0, 0)]


class Watch:
    """Stands for ``threading.Timer``: it goes off when the test says so."""

    made: ClassVar[list[Watch]] = []

    def __init__(self, seconds: float, then: Callable[[], object]) -> None:
        self.seconds, self.then = seconds, then
        self.daemon, self.state = False, "made"
        Watch.made.append(self)

    def start(self) -> None:
        assert self.daemon
        self.state = "started"

    def cancel(self) -> None:
        self.state = "cancelled"


@pytest.fixture
def watches(monkeypatch: pytest.MonkeyPatch) -> list[Watch]:
    Watch.made = []
    monkeypatch.setattr(threading, "Timer", Watch)
    return Watch.made


class Waits(threading.Event):
    """Stands for ``threading.Event``: whoever waits for it lets time pass.

    Args:
        time: The time that passes.
        share: How much of it the plan's thread has the processor.
    """

    def __init__(self, time: Time, share: float) -> None:
        super().__init__()
        self.time, self.share, self.waits = time, share, list[float]()

    def wait(self, timeout: float | None = None) -> bool:
        assert timeout is not None
        self.waits.append(timeout)
        self.time.now += timeout
        self.time.idle += (1.0 - self.share) * timeout
        return self.is_set()


@pytest.mark.parametrize(
    ("share", "end"), [(1.0, 14.0), (0.5, 24.0), (0.3, 4.0 + 10.0 / 0.3), (0.2, 44.0), (0.0, 44.0)]
)
def test_a_search_is_cut_when_processor_time_runs_out_or_four_times_as_much_wall_time(
    share: float, end: float, passing: Time, watches: list[Watch], monkeypatch: pytest.MonkeyPatch
) -> None:
    passing.now = 4.0
    clock, cut = TimeBudget(10.0), np.zeros(1, dtype=np.bool_)
    over = Waits(passing, share)
    monkeypatch.setattr(threading, "Event", lambda: over)

    def search() -> None:
        with clock.stage("ik"), clock.cutting(cut, 10**9):
            (watch,) = watches
            assert (watch.seconds, watch.state) == (10.0, "started")
            over.wait(watch.seconds)
            watch.then()
            assert cut[0]
            raise SearchCut

    with pytest.raises(BudgetExceeded) as caught:
        search()
    assert watches[0].state == "cancelled"
    assert passing.now == pytest.approx(end, abs=2e-3)  # it looks again each millisecond at most
    assert len(over.waits) < 100
    assert ("wall time" in caught.value.detail) == (share < 1.0 / WALL_FACTOR)


def test_a_search_that_ends_first_is_not_cut_by_a_timer_that_has_gone_off(
    passing: Time, watches: list[Watch]
) -> None:
    clock, cut = TimeBudget(10.0), np.zeros(1, dtype=np.bool_)
    with clock.cutting(cut, 10**9):
        pass
    watches[0].then()  # time is left
    assert not cut[0]
    passing.now = 50.0
    watches[0].then()
    assert not cut[0]


def test_a_timer_outlives_the_thread_of_its_search(watches: list[Watch]) -> None:
    """Only with the clock itself: that of a thread that has ended cannot be read."""
    cut = np.zeros(1, dtype=np.bool_)

    def search() -> None:
        with TimeBudget(1e6).cutting(cut, 10**9):
            pass

    thread = threading.Thread(target=search)
    thread.start()
    thread.join()
    watches[0].then()
    assert not cut[0]


@pytest.mark.parametrize("budget_s", [1e300, 1e9])
def test_a_budget_of_ages_is_no_error(budget_s: float, watches: list[Watch]) -> None:
    with TimeBudget(budget_s).cutting(np.zeros(1, dtype=np.bool_), 10**9):
        assert 0.0 <= watches[0].seconds <= threading.TIMEOUT_MAX


def test_a_budget_that_is_gone_cuts_a_long_search_at_once(
    passing: Time, watches: list[Watch]
) -> None:
    clock = TimeBudget(1.0)
    passing.now = 5.0
    with clock.cutting(np.zeros(1, dtype=np.bool_), 10**9):
        assert watches[0].seconds == 0.0


def test_a_search_cut_short_is_a_budget_exceeded_with_the_best_so_far(
    watches: list[Watch],
) -> None:
    clock = TimeBudget(10.0)

    def search() -> None:
        with clock.stage("ik"), clock.cutting(np.zeros(1, dtype=np.bool_), 10**9):
            clock.check({"waypoints_solved": 2})
            raise SearchCut

    with pytest.raises(BudgetExceeded) as caught:
        search()
    assert caught.value.stage == "ik"
    assert caught.value.best == {"waypoints_solved": 2}
    assert watches[0].state == "cancelled"


def test_a_search_cut_short_in_a_stage_within_another_names_it(watches: list[Watch]) -> None:
    clock = TimeBudget(10.0)

    def search() -> None:
        cut = np.zeros(1, dtype=np.bool_)
        with clock.stage("planning"), clock.cutting(cut, 10**9), clock.stage("ik"):
            raise SearchCut

    with pytest.raises(BudgetExceeded) as caught:
        search()
    assert caught.value.stage == "ik"
    assert watches[0].state == "cancelled"


def test_a_short_search_takes_no_thread(watches: list[Watch]) -> None:
    with TimeBudget(10.0).cutting(np.zeros(1, dtype=np.bool_), 100):
        assert watches == []


def test_work_of_other_threads_counts_as_far_as_they_share_it(passing: Time) -> None:
    clock = TimeBudget(10.0)
    passing.now, passing.idle = 12.0, 11.0
    clock.spend(4.0)
    assert clock.left == 5.0
    clock.spend(5.5)
    with pytest.raises(BudgetExceeded, match="processor time"):
        clock.check()


def test_without_clocks_of_threads_a_wait_for_others_counts_once(
    passing: Time, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(time, "pthread_getcpuclockid")
    clock = TimeBudget(10.0)
    passing.now = 4.0
    clock.spend(4.0)
    assert clock.left == 6.0
