"""An experiment: cases with their series, and how its results are told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from benchmarks.papers.document import Document
from benchmarks.papers.rows import Table
from benchmarks.papers.series import Series

__all__ = ["Experiment", "Results", "Study", "thinned"]


@dataclass(frozen=True)
class Study:
    """A case and the series made on it."""

    case: Case
    series: list[Series]


@dataclass(frozen=True)
class Results:
    """What was measured.

    Attributes:
        tables: Rows, by (case, series).
        curves: Convergence, by (case, series): geometric mean, median and mean over the reachable
            targets after each iteration, and the same over the others, for each run, shape
            (runs, 6, T + 1).
        runs: Runs asked for.
    """

    tables: dict[tuple[str, str], Table]
    curves: dict[tuple[str, str], NDArray[np.float64]]
    runs: int


@dataclass(frozen=True)
class Experiment:
    """An experiment.

    Attributes:
        name: E1 ... E9, D, S1, S2.
        title: What it is.
        studies: Builds the studies; takes the thinning of the targets.
        report: Writes tables and figures of the results into a document.
    """

    name: str
    title: str
    studies: Callable[[int], list[Study]]
    report: Callable[[list[Study], Results, Document], None]


def thinned(case: Case, step: int) -> Case:
    """Return the case with every ``step``-th target only."""
    if step == 1:
        return case
    return replace(
        case,
        R=case.R[::step],
        p=case.p[::step],
        reachable=case.reachable[::step],
        starts=None if case.starts is None else case.starts[::step],
    )
