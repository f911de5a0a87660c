"""E5: convergence, [K] section 4.2."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import published
from benchmarks.papers.document import Document
from benchmarks.papers.e4 import CONTROLS, PAPER
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.plots import curves, new_figure
from benchmarks.papers.series import PLANNER, Series
from benchmarks.papers.statistics import summary
from benchmarks.papers.trajectories import TRAJECTORIES, convergence_case

__all__ = ["EXPERIMENT", "T", "iterations_to", "studies"]

Array = NDArray[np.float64]

T = 1000
THRESHOLDS = (1e-5, 1e-4, 1e-3)
SERIES = [replace(s, iterations=T) for s in [*PAPER, *CONTROLS]]
OWN = Series("ikplan", PLANNER, params={"elongation": "independent"}, paper=False)


def studies(_thin: int) -> list[Study]:
    """Return one case a trajectory; searches stop at the smallest threshold."""
    return [Study(convergence_case(name, THRESHOLDS[0]), [*SERIES, OWN]) for name in TRAJECTORIES]


def iterations_to(threshold: float, curve: Array) -> Array:
    """Return the iteration at which each run reaches a threshold, T where it does not.

    Args:
        threshold: Error [m].
        curve: Best errors, shape (runs, T + 1) [m].
    """
    reached = curve <= threshold * (1.0 + 1e-6)
    return np.where(reached.any(axis=1), reached.argmax(axis=1), T).astype(np.float64)


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    document.say(
        "Point 9 of each trajectory, start q = 0, at most 1000 iterations. [K] prints the averages "
        "of iterations to 0.1e-4, of a unit not stated, and after 100 iterations its own Table 4 "
        "has PSO, WOA and GSA above that. So three thresholds, each with the share of runs that "
        "reach it, the mean over those, and the mean that counts misses as 1000."
    )
    rows = []
    for study in studies:
        for series in SERIES:
            curve = results.curves[study.case.name, series.name][:, 0]
            given = published.KANAGARAJ_CONVERGENCE[study.case.title].get(series.name)
            row: list[object] = [study.case.title, series.name, given[0] if given else None]
            for threshold in THRESHOLDS:
                needed = iterations_to(threshold, curve)
                hit = curve[:, -1] <= threshold * (1.0 + 1e-6)
                over = needed[hit].mean() if hit.any() else None
                row += [100.0 * hit.mean(), over, needed.mean()]
            table = results.tables[study.case.name, series.name]
            rows.append([*row, table["n_eval"].mean(), 1e3 * table["cpu_seconds"].mean()])
        table = results.tables[study.case.name, OWN.name]
        blank: list[object] = [100.0, None, None] * len(THRESHOLDS)
        cost = [table["n_eval"].mean(), 1e3 * table["cpu_seconds"].mean()]
        rows.append([study.case.title, OWN.name, None, *blank, *cost])
    head = ["trajectory", "series", "published"]
    for threshold in THRESHOLDS:
        head += [f"% to {threshold:.0e} m", "over those", "misses as 1000"]
    document.table([*head, "evaluations", "ms"], rows)
    document.say("Iterations to 1e-3 m, misses as 1000: mean, median, std, max, min.")
    spread = []
    for study in studies:
        for series in PAPER:
            curve = results.curves[study.case.name, series.name][:, 0]
            spread.append([study.case.title, series.name, *summary(iterations_to(1e-3, curve))])
    document.table(["trajectory", "series", "mean", "median", "std", "max", "min"], spread)
    figure, axes = new_figure(12.0, 3.3, 4)
    for i, (ax, study) in enumerate(zip(axes, studies, strict=True)):
        lines = {
            s.name: np.exp(np.log(results.curves[study.case.name, s.name][:, 0, 1:]).mean(axis=0))
            for s in SERIES
            if s.name not in ("PSO, scalar draws", "WOA, literal")
        }
        label = "error [m]" if i == 0 else ""
        curves(ax, lines, "iteration", label, log=True, first=1, legend=i == 0)
        ax.set_xscale("log")
        ax.set_title(study.case.title, fontsize=9)
    document.figure(
        figure, "E5-convergence", "E5: geometric mean of the error over the runs (Figure 6)"
    )


EXPERIMENT = Experiment("E5", "Convergence, MH5 [K, section 4.2]", studies, report)
