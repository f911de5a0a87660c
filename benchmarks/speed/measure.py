"""Measuring in calls of Pinocchio's forward kinematics, on a machine that does other things too."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ikplan.robots import Robot

__all__ = ["Figure", "FkClock", "Section", "seconds_of"]


@dataclass(frozen=True)
class Figure:
    """One measured figure.

    Attributes:
        name: What was measured.
        value: The figure.
        unit: Its unit: "x FK" for calls of the forward kinematics.
        most: Largest value that is good enough; None: reported only.
        least: Smallest value that is good enough; None: reported only.
    """

    name: str
    value: float
    unit: str
    most: float | None = None
    least: float | None = None

    @property
    def good(self) -> bool:
        """Whether the figure is within its limits."""
        above = self.most is not None and not self.value <= self.most
        return not above and not (self.least is not None and not self.value >= self.least)

    def __str__(self) -> str:
        limit = "" if self.most is None else f"   <= {self.most:g}"
        limit += "" if self.least is None else f"   >= {self.least:g}"
        verdict = "" if self.good else "   NOT REACHED"
        return f"  {self.name:<44} {self.value:>12.5g} {self.unit:<6}{limit}{verdict}"

    def as_row(self) -> dict[str, Any]:
        """The figure as JSON has it."""
        return {**asdict(self), "good": self.good}


@dataclass(frozen=True)
class Section:
    """A part of the benchmark.

    Attributes:
        name: Its name on the command line.
        title: What it measures, in words.
        run: Measures; takes a share of the full effort, in (0, 1].
    """

    name: str
    title: str
    run: Callable[[float], Sequence[Figure]]


def seconds_of(call: Callable[[], object], loops: int = 1) -> float:
    """Return the processor time of one call [s], over ``loops`` of them.

    The time of this thread: what other processes do in between does not count.
    """
    start = time.thread_time()
    for _ in range(loops):
        call()
    return (time.thread_time() - start) / loops


class FkClock:
    """Times ``pinocchio.framesForwardKinematics`` on a robot, by turns with what is measured.

    Both are taken from their least disturbed moments: a median over a short while, and of those
    the smallest.
    """

    def __init__(self, robot: Robot) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._q = robot.configuration(robot.random_configuration(np.random.default_rng(0)))
        self._whiles: list[float] = []

    def _call(self) -> None:
        pin.framesForwardKinematics(self._model, self._data, self._q)

    def tick(self) -> None:
        """Time it for a short while."""
        self._whiles.append(statistics.median(seconds_of(self._call, 50) for _ in range(9)))

    @property
    def seconds(self) -> float:
        """Time of one call [s]."""
        return min(self._whiles)

    def ratio(self, calls: Sequence[Callable[[], object]], repeats: int) -> float:
        """Return the median over ``calls`` of their time, in calls of the forward kinematics."""
        medians = []
        for _ in range(repeats):
            self.tick()
            medians.append(statistics.median(seconds_of(call) for call in calls))
        self.tick()
        return min(medians) / self.seconds
