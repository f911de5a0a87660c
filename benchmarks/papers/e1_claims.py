"""What E1 says of the claims of [S], and why IK-BA misses where it does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import published
from benchmarks.papers.case import Case
from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED, short, smallest, told
from benchmarks.papers.document import Document
from benchmarks.papers.e1_series import (
    CLOUD,
    GREEDY,
    IK_BA,
    LEAST,
    MISS,
    PAPER,
    REFERENCES,
    UNIFORM,
    WHOLE,
    around,
    per_run,
)
from benchmarks.papers.experiment import Results, Study
from benchmarks.papers.statistics import (
    Comparison,
    Estimate,
    adjusted,
    estimate,
    over_runs,
    share,
    welch,
)

__all__ = ["claims", "far_from_the_edge", "misses"]

CASES = ("E1a", "E1b", "E1c")
EDGE = 0.8175
"""Distance of the wrist from the shoulder beyond which the arm is nearly straight [m]; 0.82 is its
reach."""
SHOULDER = np.array([0.0, 0.0, 0.36])
WRIST = 0.126
QUANTITIES = (("eps_p", "error"), ("elongation_deg", "variation"))


def far_from_the_edge(case: Case) -> NDArray[np.bool_]:
    """Return which points of a decoupled case are not at the very edge of the reach."""
    wrist = case.p - WRIST * case.R[:, :, 2]
    far: NDArray[np.bool_] = np.linalg.norm(wrist - SHOULDER, axis=1) < EDGE
    return far


def misses(study: Study, results: Results, document: Document) -> None:
    """Why the mean of IK-BA is what it is: solves that end at a joint limit, points at the edge."""
    case = study.case
    lower, upper = case.arm.lower[: case.width], case.arm.upper[: case.width]
    for series in (IK_BA, UNIFORM, CLOUD):
        table = results.tables[case.name, series.name]
        error: NDArray[np.float64] = 100.0 * table["eps_p"]
        x = table.q[:, : case.width]
        at_limit = ((x <= lower + 1e-6) | (x >= upper - 1e-6)).any(axis=1)
        missed = np.asarray(error > MISS)
        runs = np.asarray((100.0 * table.grid("eps_p") > MISS).any(axis=1))
        text = (
            f"{series.name}: {int(missed.sum())} of {len(error)} solves miss by more than {MISS} "
            f"cm, in {int(runs.sum())} of {len(runs)} runs; {int((missed & at_limit).sum())} of "
            "them have a searched joint at its limit. The other solves have a mean error of "
            f"{error[~missed].mean():.4g} cm."
        )
        if case.decouple and not far_from_the_edge(case).all():
            far = table.where(far_from_the_edge(case))
            points = ", ".join(str(k + 1) for k in np.flatnonzero(~far_from_the_edge(case)))
            text += (
                f" Without the points {points}, where the arm is all but straight: "
                f"{100.0 * far['eps_p'].mean():.4g} cm over all solves."
            )
        document.say(text)


def _figures(results: Results, document: Document) -> None:
    """IK-BA's error and variation, and those of the five others, against Table 3."""
    given = published.SLIM_TABLE_3
    for case in CASES:
        for series, words in (
            (IK_BA, "noise of bat code, 0.1 N(0, 1)"),
            (CLOUD, "the same, first population around the start"),
            (UNIFORM, "noise uniform in [-1, 1)"),
        ):
            grid = 100.0 * results.tables[case, series.name].grid("eps_p")
            mean, middle, deviation, largest, _ = given["eps_p"]["IK-BA"]
            below = share(grid.mean(axis=1), largest)
            document.figure_claim(
                f"{case}: mean position error of IK-BA, {words}",
                mean,
                estimate(grid),
                "cm",
                f"median {short(float(np.median(grid)))}; runs at or below the published maximum, "
                f"{largest:g}: {100.0 * below.value:.0f} % ({100.0 * below.low:.0f} to "
                f"{100.0 * below.high:.0f}); Welch p = "
                f"{welch(grid.mean(axis=1), mean, deviation, 20):.1g}",
            )
            document.figure_claim(
                f"{case}: median of the run means of the error of IK-BA, {words}",
                middle,
                estimate(grid, _middle),
                "cm",
            )
            grid = results.tables[case, series.name].grid("elongation_deg")
            mean, _, deviation, _, _ = given["elongation_deg"]["IK-BA"]
            document.figure_claim(
                f"{case}: mean joint variation of IK-BA, {words}",
                mean,
                estimate(grid),
                "deg",
                f"Welch p = {welch(grid.mean(axis=1), mean, deviation, 20):.1g}",
            )
    for series in PAPER[1:]:
        for column, what, factor, unit in (
            ("eps_p", "error", 100.0, "cm"),
            ("elongation_deg", "joint variation", 1.0, "deg"),
        ):
            document.figure_claim(
                f"E1b: median of the run means of the {what} of {_title(series.name)}",
                given[column][series.name][1],
                estimate(factor * results.tables["E1b", series.name].grid(column), _middle),
                unit,
            )


def _middle(grid: NDArray[np.float64]) -> float:
    """What Table 3 calls median: of the means of the runs."""
    return float(np.median(grid.mean(axis=1)))


def _title(name: str) -> str:
    return {"PSO": "PSO, constants permuted", "ABC": "ABC, a stand-in for K-ABC"}.get(name, name)


def _is_smallest(results: Results, document: Document) -> None:
    """Whether IK-BA has the smallest error and variation of the six, on each reading."""
    for column, title in QUANTITIES:
        for cloud in (False, True):
            names = [around(s).name if cloud else s.name for s in PAPER]
            tests: dict[str, list[Comparison]] = {}
            for case in CASES:
                values = [per_run(results.tables[case, n], column) for n in names]
                tests[case] = [over_runs(values[0], v) for v in values[1:]]
            family = adjusted([t for case in CASES for t in tests[case]])
            for i, case in enumerate(CASES):
                of_case = family[5 * i : 5 * i + 5]
                means = {n: results.tables[case, n][column].mean() for n in names}
                order = sorted(means, key=lambda n: float(means[n]))
                worst = max(of_case, key=lambda c: (c.second_is_smaller, c.p))
                rival = names[1 + of_case.index(worst)]
                plain = " < ".join(n.removesuffix(", cloud") for n in order)
                started = ", all begun around the start" if cloud else ""
                document.claim(
                    f"{case}: IK-BA has the smallest {title} of the six{started}",
                    "not done" if cloud else "yes (ANOVA of all six)",
                    f"by means: {plain}",
                    worst.n,
                    f"Mann-Whitney, Holm over 15: against {rival.removesuffix(', cloud')} "
                    f"{worst.told()}",
                    smallest(of_case),
                )


def _references(results: Results, document: Document) -> None:
    """IK-BA against CMA-ES and L-SHADE begun around the start: error and variation."""
    for column, title in QUANTITIES:
        pairs = [(case, s) for case in CASES for s in REFERENCES]
        tests = adjusted(
            [
                over_runs(
                    per_run(results.tables[case, CLOUD.name], column),
                    per_run(results.tables[case, around(s).name], column),
                )
                for case, s in pairs
            ]
        )
        for (case, s), test in zip(pairs, tests, strict=True):
            own = estimate(results.tables[case, CLOUD.name].grid(column))
            other = estimate(results.tables[case, around(s).name].grid(column))
            factor = 100.0 if column == "eps_p" else 1.0
            figures = [
                f"{short(factor * e.value)} ({short(factor * e.low)} to {short(factor * e.high)})"
                for e in (own, other)
            ]
            document.claim(
                f"{case}: IK-BA has a smaller {title} than {s.name}, both begun around the start",
                "not done",
                f"{figures[0]} against {figures[1]} {'cm' if column == 'eps_p' else 'deg'}",
                own.n,
                f"{test.test}, Holm over 6: {test.told()}",
                HOLDS if test.first_is_smaller else FAILS if test.second_is_smaller else UNDECIDED,
            )


def _least_motion(results: Results, document: Document) -> None:
    for case in CASES:
        least = results.tables[case, LEAST.name].grid("elongation_deg").sum()
        sums = {
            s.name: results.tables[case, s.name].grid("elongation_deg")
            for s in (WHOLE, GREEDY, IK_BA)
        }
        ratios = {n: estimate(grid.sum(axis=1)[:, None] / least) for n, grid in sums.items()}
        own, whole, greedy = (ratios[s.name] for s in (IK_BA, WHOLE, GREEDY))
        document.claim(
            f"{case}: the whole path by IK-BA moves the joints more than the least motion found",
            "not done",
            f"IK-BA {told(own)} times, ikplan {_finely(whole)}, point by point {_finely(greedy)}",
            own.n.partition(" x")[0],
            "bootstrap over runs; the least motion is that of 12 restarts",
            HOLDS if own.low > 1.0 else UNDECIDED,
        )


def _finely(value: Estimate) -> str:
    return f"{value.value:.4f} ({value.low:.4f} to {value.high:.4f})"


def claims(studies: dict[str, Study], results: Results, document: Document) -> None:
    """Fill the summary."""
    del studies
    _figures(results, document)
    if results.runs >= 3:
        _is_smallest(results, document)
        _references(results, document)
    _least_motion(results, document)
