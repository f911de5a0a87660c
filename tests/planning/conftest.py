"""Time that the tests of the budget make up."""

from __future__ import annotations

import time

import pytest

__all__ = ["Time"]


class Time:
    """Time [s] that a test sets; each look at it adds ``a_look``."""

    def __init__(self) -> None:
        self.now, self.a_look, self.looks = 0.0, 0.0, 0

    def __call__(self) -> float:
        self.looks += 1
        self.now += self.a_look
        return self.now


@pytest.fixture
def passing(monkeypatch: pytest.MonkeyPatch) -> Time:
    made_up = Time()
    monkeypatch.setattr(time, "perf_counter", made_up)
    return made_up
