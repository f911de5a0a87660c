"""E2: time to 0.1 cm, [S] section 5.3.1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import published
from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED
from benchmarks.papers.document import Document, slashed
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.helix import random_targets
from benchmarks.papers.plots import boxes, new_figure
from benchmarks.papers.rows import Table
from benchmarks.papers.series import PLANNER, Series
from benchmarks.papers.statistics import adjusted, estimate, over_targets, summary

__all__ = ["EXPERIMENT"]

SIZES = (12, 15, 20, 30)
T = 1000
METHODS: dict[str, tuple[str, dict[str, object]]] = {
    "IK-BA": ("ik-ba", {"preset": "bat-code"}),
    "IK-BA, uniform noise": ("ik-ba", {"preset": "slim"}),
    "BA": ("ba", {}),
    "DE": ("de-rand-1", {"preset": "slim"}),
    "PSO": ("pso", {"preset": "slim-permuted"}),
    "PSO, as printed": ("pso", {"preset": "slim"}),
    "ABC": ("abc", {}),
    "CMA-ES": ("cma-es", {}),
    "L-SHADE": ("l-shade", {}),
}
OWN = Series("ikplan", PLANNER, params={"elongation": "independent"}, paper=False)


def studies(_thin: int) -> list[Study]:
    """Return the one case: 20 targets, stop at 1 mm, start at home."""
    series = [
        Series(f"{name}, N = {n}", method, n, T, dict(params))
        for name, (method, params) in METHODS.items()
        for n in SIZES
    ]
    return [Study(random_targets(20), [*series, OWN])]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    study = studies[0]
    document.say(
        "20 random reachable positions, the same in every run; 7 joints, start home, stop at 1 mm, "
        f"T = {T}. Published, in ms: IK-BA with N = 12, 15, 20, 30. Iterations, evaluations and "
        "processor time: mean / median / std / max / min over all solves, misses included with "
        "what they spent. The project's own planner stops at 1e-9 m, not at 1 mm."
    )
    rows = []
    for series in study.series:
        table = results.tables[study.case.name, series.name]
        hit = table["eps_p"] <= 1e-3
        size = series.population
        given = published.SLIM_TIMES.get(size or 0) if series.name.startswith("IK-BA, N") else None
        milliseconds = 1e3 * table["cpu_seconds"]
        rows.append(
            [
                series.name,
                slashed(given),
                slashed(summary(milliseconds)),
                slashed(summary(table["n_iter"])),
                slashed(summary(table["n_eval"])),
                100.0 * hit.mean(),
                100.0 * (milliseconds < 50.0).mean(),
            ]
        )
    document.table(
        ["series", "published ms", "ms", "iterations", "evaluations", "% solved", "% < 50 ms"], rows
    )
    figure, axes = new_figure(9.0, 3.4)
    evaluations = {
        s.name: results.tables[study.case.name, s.name]["n_eval"]
        for s in study.series
        if "uniform" not in s.name and "printed" not in s.name
    }
    boxes(axes[0], evaluations, "evaluations to 1 mm", log=True)
    document.figure(figure, "E2-evaluations", "E2: evaluations until the stop, misses included")
    ratio = [results.tables[study.case.name, f"IK-BA, N = {n}"]["n_iter"].mean() for n in SIZES]
    document.say(
        "The number of iterations hardly depends on N, since the cooling 0.97^t sets it: "
        + ", ".join(f"N = {n}: {v:.0f}" for n, v in zip(SIZES, ratio, strict=True))
        + ". So the time grows with N."
    )
    few, many = (results.tables[study.case.name, f"IK-BA, N = {n}"] for n in (SIZES[0], SIZES[-1]))
    theirs = published.SLIM_TIMES[SIZES[-1]][0] / published.SLIM_TIMES[SIZES[0]][0]
    # Evaluations, whose order the clock of the day does not change; on the same targets.
    grids = np.stack([few.grid("n_eval"), many.grid("n_eval")], axis=2)
    ours = estimate(grids, lambda v: float(v[..., 1].mean() / v[..., 0].mean()))
    document.figure_claim(
        f"E2: cost of IK-BA to 1 mm with {SIZES[-1]} bats over that with {SIZES[0]}",
        round(theirs, 2),
        ours,
        "",
        "evaluations here, milliseconds there (181 over 48)",
    )
    _references(study, results, document)


def few_n(table: Table) -> str:
    """Return what a figure of this case is made of."""
    runs, targets = table.grid("n_eval").shape
    return f"{runs} runs x {targets} targets"


def _references(study: Study, results: Results, document: Document) -> None:
    """IK-BA with 12 bats against each other search of the same budget, evaluations to 1 mm."""
    size = SIZES[0]

    def median(name: str) -> NDArray[np.float64]:
        spent: NDArray[np.float64] = results.tables[study.case.name, f"{name}, N = {size}"].grid(
            "n_eval"
        )
        return np.asarray(np.median(spent, axis=0), dtype=np.float64)

    others = [name for name in METHODS if name != "IK-BA"]
    tests = adjusted([over_targets(median("IK-BA"), median(name)) for name in others])
    for name, test in zip(others, tests, strict=True):
        table = results.tables[study.case.name, f"{name}, N = {size}"]
        own = results.tables[study.case.name, f"IK-BA, N = {size}"]
        met, theirs = (estimate((t.grid("eps_p") <= 1e-3).astype(float)) for t in (own, table))
        document.claim(
            f"E2: IK-BA needs fewer evaluations to 1 mm than {name}, N = {size}, T = {T}",
            "not done",
            f"medians {np.median(own['n_eval']):,.0f} against {np.median(table['n_eval']):,.0f}; "
            f"solved {100 * met.value:.0f} % ({100 * met.low:.0f} to {100 * met.high:.0f}) against "
            f"{100 * theirs.value:.0f} % ({100 * theirs.low:.0f} to {100 * theirs.high:.0f})",
            few_n(own),
            f"{test.test} over medians a target, Holm over {len(others)}: {test.told()}",
            HOLDS if test.first_is_smaller else FAILS if test.second_is_smaller else UNDECIDED,
        )


EXPERIMENT = Experiment("E2", "Time to 0.1 cm [S, section 5.3.1]", studies, report)
