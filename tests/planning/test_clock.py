"""The clock of a plan: what is left, what was best, and how it ends long searches.

Time is made up: nothing here waits or is measured.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import pytest

from ikplan import BudgetExceeded
from ikplan.planning import TimeBudget
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

    def __init__(self, seconds: float, then: Callable[..., Any], args: Any) -> None:
        self.seconds, self.then, self.args = seconds, then, args
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


def test_a_long_search_is_watched_for_just_the_time_left(
    passing: Time, watches: list[Watch]
) -> None:
    clock, cut = TimeBudget(10.0), np.zeros(1, dtype=np.bool_)
    passing.now = 4.0
    with clock.stage("ik"), clock.cutting(cut, 10**9):
        (watch,) = watches
        assert (watch.seconds, watch.state) == (6.0, "started")
        assert not cut[0]
        watch.then(*watch.args)
        assert cut[0]
    assert watch.state == "cancelled"


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
