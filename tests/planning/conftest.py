"""Time that the tests of the budget make up."""

from __future__ import annotations

import time

import pytest

__all__ = ["Time"]


class Time:
    """Time [s] that a test sets; each look at it adds ``a_look``.

    The thread has the processor for itself, unless ``idle`` says how long it had not [s].
    """

    def __init__(self) -> None:
        self.now, self.a_look, self.looks, self.idle = 0.0, 0.0, 0, 0.0

    def __call__(self) -> float:
        self.looks += 1
        self.now += self.a_look
        return self.now

    def processor(self, _: int) -> float:
        return self.now - self.idle


@pytest.fixture
def passing(monkeypatch: pytest.MonkeyPatch) -> Time:
    made_up = Time()
    monkeypatch.setattr(time, "perf_counter", made_up)
    monkeypatch.setattr(time, "clock_gettime", made_up.processor)
    return made_up
