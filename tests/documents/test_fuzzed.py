"""Damaged documents of every kind, some of each; ``make fuzz`` draws them for half an hour."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import pytest

from benchmarks.fuzz import run
from benchmarks.fuzz.targets import TARGETS, Target
from ikplan.errors import IkplanError


@pytest.mark.parametrize("name", TARGETS)
def test_every_document_is_read_or_refused(name: str) -> None:
    report = run.fuzz(name, first_seed=2026, rounds=1, examples=40)
    assert report.faults == []
    assert report.refused > 0
    assert report.slowest_s < run.MOST_S


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (lambda _: 1 // 0, "ZeroDivisionError"),
        (lambda _: _spend(0.2), "TooSlow"),
    ],
)
def test_what_is_no_refusal_or_takes_long_is_a_fault(
    fault: Callable[[bytes], Any], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    fine = TARGETS["poses"]
    monkeypatch.setitem(TARGETS, "poses", Target(fault, fine.documents))
    monkeypatch.setattr(run, "MOST_S", 0.1)
    report = run.fuzz("poses", rounds=1, examples=5)
    assert len(report.faults) == 1
    assert told in report.faults[0]


def _spend(seconds: float) -> None:
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def test_an_error_of_the_library_is_a_refusal(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: bytes) -> None:
        raise IkplanError("no")

    monkeypatch.setitem(TARGETS, "poses", Target(refuse, TARGETS["poses"].documents))
    report = run.fuzz("poses", rounds=1, examples=5)
    assert (report.read, report.faults) == (0, [])
