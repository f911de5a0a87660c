"""A request's budget stands still while kernels are compiled, also for a search under way."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

from ikplan import BudgetExceeded
from ikplan._kernels import clock as clocks
from ikplan._kernels.clock import counting, kernel_seconds, thread_kernels
from ikplan.pipeline.request_budget import RequestBudget
from ikplan.time_budget import SearchCut

LONG = 10**9
"""Evaluations of a search that a thread watches."""


class Time:
    """The clocks of the wall and of the thread, which are set by hand."""

    def __init__(self) -> None:
        self.now, self.worked = 100.0, 10.0

    def perf_counter(self) -> float:
        return self.now

    def clock_gettime(self, _: int) -> float:
        return self.worked

    def passes(self, seconds: float, worked: float | None = None) -> None:
        """Let time pass, and the thread work for all or some of it."""
        self.now += seconds
        self.worked += seconds if worked is None else worked


@pytest.fixture
def hand(monkeypatch: pytest.MonkeyPatch) -> Time:
    hand = Time()
    monkeypatch.setattr(time, "perf_counter", hand.perf_counter)
    monkeypatch.setattr(time, "clock_gettime", hand.clock_gettime)
    return hand


def test_compiling_takes_nothing_from_the_budget_and_from_no_stage(hand: Time) -> None:
    hand.passes(3.0)
    budget = RequestBudget(10.0)
    with budget.stage("ik"):
        hand.passes(2.0)
        with counting():
            hand.passes(60.0)
            assert budget.left == pytest.approx(8.0)  # while it is going on
            with counting():  # a kernel that this one calls
                hand.passes(5.0)
        hand.passes(1.0)
    with budget.stage("timing"):
        hand.passes(4.0)
    assert budget.seconds == pytest.approx({"ik": 3.0, "timing": 4.0})
    assert budget.left == pytest.approx(3.0)
    hand.passes(3.5)
    with pytest.raises(BudgetExceeded):
        budget.check()


def test_compiling_takes_nothing_from_either_clock_whoever_does_it(hand: Time) -> None:
    budget = RequestBudget(10.0)
    hand.passes(4.0, worked=3.0)
    assert budget.left == pytest.approx(7.0)
    with counting():  # by other processes that this thread waits for, and by itself
        hand.passes(60.0, worked=2.0)
        assert budget.left == pytest.approx(7.0)
        hand.passes(60.0, worked=20.0)
    assert budget.left == pytest.approx(7.0)

    def compile_beside() -> None:
        with counting():
            hand.passes(8.0, worked=1.0)

    thread = threading.Thread(target=compile_beside)
    thread.start()
    thread.join()
    # Of this thread's processor time only what it puts into kernels itself is left out.
    assert budget.left == pytest.approx(6.0)
    hand.passes(28.0, worked=0.0)
    assert budget.left == pytest.approx(2.0)
    with budget.stage("ik"):
        hand.passes(8.1, worked=0.0)
        with pytest.raises(BudgetExceeded, match="wall time"):
            budget.check()


def test_kernels_that_were_compiled_before_do_not_lengthen_a_budget(hand: Time) -> None:
    with counting():
        hand.passes(100.0)
    budget = RequestBudget(1.0)
    hand.passes(1.5)
    assert budget.left == pytest.approx(-0.5)


def test_what_fails_to_compile_is_counted_and_ends(hand: Time) -> None:
    before = kernel_seconds()

    def fails() -> None:
        with counting():
            hand.passes(2.0)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails()
    hand.passes(5.0)
    assert kernel_seconds() - before == pytest.approx(2.0)
    assert clocks._process._depth == thread_kernels()._depth == 0


def waits(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + 10.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.001)


def test_a_search_is_cut_when_the_budget_runs_out_and_not_while_it_is_compiled() -> None:
    cut = np.zeros(1, dtype=np.bool_)
    budget = RequestBudget(0.2)

    def search() -> None:
        with budget.stage("ik"), budget.cutting(cut, LONG):
            with counting():
                time.sleep(0.5)
                assert not cut[0]
            waits(lambda: bool(cut[0]))
            assert budget.left <= 0.0
            raise SearchCut

    with pytest.raises(BudgetExceeded):
        search()


def test_a_search_that_is_over_is_not_cut_afterwards() -> None:
    cut = np.zeros(1, dtype=np.bool_)
    budget = RequestBudget(0.05)
    with counting():  # which keeps whoever watches waiting
        with budget.cutting(cut, LONG):
            time.sleep(0.1)
        watching = [t for t in threading.enumerate() if isinstance(t, threading.Timer)]
    for thread in watching:
        thread.join(10.0)
    assert not cut[0]
