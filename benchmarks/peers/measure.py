"""What the peers have in common: contestants, measured in turns, and rows of ratios."""

from __future__ import annotations

import importlib
import itertools
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.speed.measure import seconds_of

__all__ = ["Contestant", "Row", "compare", "module"]


@dataclass(frozen=True)
class Contestant:
    """One library at one work.

    Attributes:
        name: The library, and what of it.
        calls: The work, on one input after the other.
        note: What it does not do, or does beside.
    """

    name: str
    calls: Sequence[Callable[[], object]]
    note: str = ""


@dataclass(frozen=True)
class Row:
    """What was measured.

    Attributes:
        work: The work.
        name: Who did it.
        seconds: Median processor time of one input [s].
        beside: How many times what ikplan takes: above 1, ikplan is faster.
        note: As of the contestant.
    """

    work: str
    name: str
    seconds: float
    beside: float
    note: str


def module(name: str) -> Any:
    """Return an optional library, or None where it is not installed here."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def compare(work: str, contestants: Sequence[Contestant], rounds: int) -> list[Row]:
    """Time contestants by turns, so that a disturbance of the machine meets all of them.

    Args:
        work: What they do.
        contestants: Who; the first is ikplan.
        rounds: How often each goes over all inputs.
    """
    medians: list[list[float]] = [[] for _ in contestants]
    for each in contestants:
        each.calls[0]()
    for _, (k, each) in itertools.product(range(rounds), enumerate(contestants)):
        medians[k].append(statistics.median(seconds_of(call) for call in each.calls))
    least = [min(times) for times in medians]
    return [
        Row(work, each.name, seconds, seconds / least[0], each.note)
        for each, seconds in zip(contestants, least, strict=True)
    ]
