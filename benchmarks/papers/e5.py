"""E5: convergence, [K] section 4.2."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import published
from benchmarks.papers.claims import FAILS, HOLDS, told
from benchmarks.papers.document import Document, slashed
from benchmarks.papers.e4 import CONTROLS, PAPER, REFERENCES
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.plots import curves, legend_below, new_figure
from benchmarks.papers.series import PLANNER, Series
from benchmarks.papers.statistics import estimate, share, summary
from benchmarks.papers.trajectories import TRAJECTORIES, convergence_case

__all__ = ["EXPERIMENT", "T", "iterations_to", "studies"]

Array = NDArray[np.float64]

T = 1000
THRESHOLDS = (1e-5, 1e-4, 1e-3)
SERIES = [replace(s, iterations=T) for s in [*PAPER, *CONTROLS, *REFERENCES]]
SHOWN = (
    *(s.name for s in [*PAPER, *REFERENCES]),
    "BAT, shared",
    "GSA, alpha 20",
    "PSO, vector draws",
)
"""Series that are drawn."""
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
        solved: list[object] = []
        for threshold in THRESHOLDS:
            solved += [100.0 * (table["eps_p"] <= threshold).mean(), None, None]
        cost = [table["n_eval"].mean(), 1e3 * table["cpu_seconds"].mean()]
        rows.append([study.case.title, OWN.name, None, *solved, *cost])
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
    _costs(studies, results, document)
    _claims(studies, results, document)
    figure, axes = new_figure(12.0, 6.2, 4, 2, same_y=True)
    for i, study in enumerate(studies):
        for line, what in enumerate(("geometric mean", "median")):
            lines = {}
            for s in SERIES:
                if s.name not in SHOWN:
                    continue
                # One target: its error is what the first row of a run's curves has.
                errors = results.curves[study.case.name, s.name][:, 0, 1:]
                middle = np.median(errors, axis=0)
                lines[s.name] = np.exp(np.log(errors).mean(axis=0)) if line == 0 else middle
            ax = axes[4 * line + i]
            label = f"error [m], {what}" if i == 0 else ""
            curves(ax, lines, "iteration", label, log=True, first=1)
            ax.set_xscale("log")
            ax.set_title(study.case.title, fontsize=9)
    legend_below(figure, axes[0])
    document.figure(
        figure, "E5-convergence", "E5: error over the iterations, over the runs (Figure 6)"
    )


def _costs(studies: list[Study], results: Results, document: Document) -> None:
    with document.details("Evaluations and processor time until the stop at 1e-5 m or 1000"):
        document.say("Mean / median / std / max / min over the runs.")
        rows = []
        for study in studies:
            for s in study.series:
                table = results.tables[study.case.name, s.name]
                evaluations = slashed(summary(table["n_eval"]))
                milliseconds = slashed(summary(1e3 * table["cpu_seconds"]))
                rows.append([study.case.title, s.name, evaluations, milliseconds])
        document.table(["trajectory", "series", "evaluations", "ms"], rows)


def _claims(studies: list[Study], results: Results, document: Document) -> None:
    given = published.KANAGARAJ_CONVERGENCE
    for name in (s.name for s in [*PAPER, *REFERENCES]):
        curves = [results.curves[study.case.name, name][:, 0] for study in studies]
        needed = np.column_stack([iterations_to(THRESHOLDS[0], c) for c in curves])
        met = np.column_stack([c[:, -1] <= THRESHOLDS[0] * (1.0 + 1e-6) for c in curves])
        hit = share(np.where(met.ravel(), 0.0, 1.0), 0.5)
        words = (
            f"{100 * hit.value:.0f} % ({100 * hit.low:.0f} to {100 * hit.high:.0f}) of the runs "
            f"get to 1e-5 m within {T}"
            + ("" if met.all() else ", so that the mean is at least this")
        )
        if name in (s.name for s in REFERENCES):
            document.claim(
                f"E5: {name} reaches 1e-5 m in every run",
                "not done",
                f"mean iterations {told(estimate(needed))}, misses as {T}; {words}",
                f"{met.size} runs",
                "Wilson's interval of the share",
                HOLDS if met.all() else FAILS,
            )
            continue
        mean = float(np.mean([given[study.case.title][name][0] for study in studies]))
        document.figure_claim(
            f"E5: iterations of {name} to 0.1e-4, mean over the trajectories, misses as {T}",
            mean,
            estimate(needed),
            "",
            words,
        )


EXPERIMENT = Experiment("E5", "Convergence, MH5 [K, section 4.2]", studies, report)
