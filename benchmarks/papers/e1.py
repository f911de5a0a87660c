"""E1: the helix, [S] section 5.2."""

from __future__ import annotations

import numpy as np

from benchmarks.papers import published
from benchmarks.papers.document import Document, slashed
from benchmarks.papers.e1_figures import draw
from benchmarks.papers.e1_series import (
    CALIBRATED,
    CLOUD,
    CONTROLS,
    GREEDY,
    IK_BA,
    LEAST,
    MISS,
    OWN,
    PAPER,
    WHOLE,
    WRIST,
    per_run,
)
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.helix import helix_cases
from benchmarks.papers.statistics import anova, holm, paired, summary

__all__ = ["EXPERIMENT"]


def studies(_thin: int) -> list[Study]:
    """Return the five cases."""
    built = helix_cases()
    decoupled = [*PAPER, *CONTROLS, WRIST]
    return [
        Study(built["E1a"], [*PAPER, *CONTROLS, *OWN]),
        Study(built["E1b"], [*decoupled, *OWN]),
        Study(built["E1c"], [*decoupled, *OWN]),
        Study(built["E1d"], [*decoupled, WHOLE, GREEDY]),
        Study(built["E1b-bent"], [*PAPER, CALIBRATED, CLOUD, *OWN]),
    ]


def _overview(study: Study, results: Results, document: Document) -> None:
    """One line a series: error, orientation, elongation, cost, limits."""
    case = study.case
    best = results.tables.get((case.name, LEAST.name))
    least = float(best.grid("elongation_deg")[0].sum()) if best is not None else np.nan
    rows: list[list[object]] = []
    for series in study.series:
        table = results.tables[case.name, series.name]
        error = 100.0 * table.grid("eps_p")
        motion = table.grid("elongation_deg")
        rows.append(
            [
                series.name,
                error.mean(),
                float(np.median(error)),
                error.max(),
                100.0 * (error > MISS).mean(),
                table.grid("theta_deg").max() if case.oriented else None,
                motion.mean(),
                table.grid("elongation_searched_deg").mean() if case.oriented else None,
                motion.sum(axis=1).mean() / least,
                table["n_eval"].mean(),
                1e3 * table["cpu_seconds"].mean(),
                100.0 * (table["violations"] > 0).mean(),
            ]
        )
    document.table(
        [
            "series",
            "error mean cm",
            "median",
            "max",
            f"% above {MISS} cm",
            "theta max deg",
            "elongation mean deg",
            "searched joints",
            "x least motion",
            "evaluations",
            "ms",
            "% outside limits",
        ],
        rows,
    )


def _misses(study: Study, results: Results, document: Document) -> None:
    """Why the mean of IK-BA is what it is: solves that end at a joint limit."""
    case = study.case
    lower, upper = case.arm.lower[: case.width], case.arm.upper[: case.width]
    for series in (IK_BA, CALIBRATED):
        table = results.tables[case.name, series.name]
        error = 100.0 * table["eps_p"]
        x = table.q[:, : case.width]
        at_limit = ((x <= lower + 1e-6) | (x >= upper - 1e-6)).any(axis=1)
        missed = error > MISS
        runs = np.array([bool((run > MISS).any()) for run in 100.0 * table.grid("eps_p")])
        document.say(
            f"{series.name}: {int(missed.sum())} of {len(error)} solves miss by more than {MISS} "
            f"cm, in {int(runs.sum())} of {len(runs)} runs; {int((missed & at_limit).sum())} of "
            "them have a searched joint at its limit. The other solves have a mean error of "
            f"{error[~missed].mean():.4g} cm."
        )


def _beside_published(study: Study, results: Results, document: Document) -> None:
    """Table 3: per run (the mean over 20 points), published beside ours, and per point."""
    case = study.case
    for column, title, factor in (
        ("eps_p", "Position error, cm", 100.0),
        ("elongation_deg", "Joint variation, deg", 1.0),
    ):
        document.say(f"{title}: mean / median / std (ddof 1) / max / min.")
        rows = []
        for series in [*PAPER, CALIBRATED]:
            table = results.tables[case.name, series.name]
            runs = summary(per_run(table, column, factor))
            points = summary(factor * table.grid(column).mean(axis=0))
            given = published.SLIM_TABLE_3[column].get(series.name)
            rows.append([series.name, slashed(given), slashed(runs), slashed(points)])
        document.table(["series", "published", "ours, 20 runs", "ours, 20 points"], rows)


def _analysis(study: Study, results: Results, document: Document) -> None:
    """Tables 4-6 and what unequal variances ask for."""
    case = study.case
    rows = []
    for column, title, factor in (
        ("eps_p", "position error", 100.0),
        ("elongation_deg", "variation", 1.0),
        ("cpu_seconds", "time", 1.0),
    ):
        given = published.SLIM_ANOVA[column]
        rows.append([f"{title}, published", *given, None, None, None])
        groups = [per_run(results.tables[case.name, s.name], column, factor) for s in PAPER]
        a = anova(groups)
        ours = [a.ss_between, a.ss_within, a.F, a.p, a.levene, a.welch, a.kruskal]
        rows.append([f"{title}, ours", *ours])
    document.table(
        ["quantity", "SS between", "SS within", "F", "p", "Levene p", "Welch p", "Kruskal p"], rows
    )
    document.say(
        "Welch: the Alexander-Govern test. Time: processor time of one solve; the published is of "
        "MATLAB, and only ratios compare."
    )
    document.say(
        "IK-BA against each, paired by run; effect: matched-pairs rank-biserial, -1 where IK-BA is "
        "smaller in every run; p by Wilcoxon, adjusted by Holm within the column."
    )
    pairs: list[list[object]] = []
    columns = (("eps_p", "error"), ("elongation_deg", "elongation"))
    adjusted, effects = {}, {}
    others = [s for s in study.series if s.name not in (IK_BA.name, LEAST.name)]
    for column, _ in columns:
        own = per_run(results.tables[case.name, IK_BA.name], column)
        tests = [paired(own, per_run(results.tables[case.name, s.name], column)) for s in others]
        adjusted[column] = holm([p for p, _ in tests])
        effects[column] = [effect for _, effect in tests]
    for i, series in enumerate(others):
        row: list[object] = [series.name]
        for column, _ in columns:
            row += [adjusted[column][i], effects[column][i]]
        pairs.append(row)
    document.table(["IK-BA against", "error p", "effect", "elongation p", "effect"], pairs)


def _ranking(study: Study, results: Results, document: Document) -> None:
    """Whether the published order holds."""
    for column, title in (("eps_p", "error"), ("elongation_deg", "elongation")):
        given = published.SLIM_TABLE_3[column]
        theirs = sorted(given, key=lambda name: given[name][0])
        means = {
            s.name: float(results.tables[study.case.name, s.name][column].mean()) for s in PAPER
        }
        ours = sorted(means, key=lambda name: means[name])
        document.say(
            f"Order by mean {title}: published {' < '.join(theirs)}; ours {' < '.join(ours)}."
        )


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    document.say(
        "N = 50, T = 200, so 10,050 evaluations each (ABC 10,025 and its scouts): the comparison "
        "is at equal evaluations. Every series tracks the path from home, each point from the "
        "solution before. ABC stands in for K-ABC, whose equations are not openly available. "
        "`warm`: individual 0 is the start. `x least motion`: summed elongation over that of the "
        "last line, the shortest path found by many restarts."
    )
    for study in studies:
        case = study.case
        document.heading(f"{case.name}: {case.title}", 3)
        if not case.reachable.all():
            _split(study, results, document)
            continue
        _overview(study, results, document)
        if case.name in ("E1a", "E1b"):
            _ranking(study, results, document)
        if case.name in ("E1a", "E1b"):
            _misses(study, results, document)
            _beside_published(study, results, document)
            if results.runs >= 3:
                _analysis(study, results, document)
        if case.name == "E1b":
            draw(study, results, document)


def _split(study: Study, results: Results, document: Document) -> None:
    """Reachable and unreachable points apart."""
    case = study.case
    document.say(
        f"{int(case.reachable.sum())} points can be reached; points "
        f"{', '.join(str(k + 1) for k in np.flatnonzero(~case.reachable))} cannot."
    )
    rows = []
    for series in study.series:
        table = results.tables[case.name, series.name]
        inside, outside = table.where(case.reachable), table.where(~case.reachable)
        rows.append(
            [
                series.name,
                100.0 * inside["eps_p"].mean(),
                100.0 * float(np.median(inside["eps_p"])),
                100.0 * inside["eps_p"].max(),
                inside["elongation_deg"].mean(),
                100.0 * outside["eps_p"].mean(),
                100.0 * outside["eps_p"].min(),
            ]
        )
    document.table(
        [
            "series",
            "reachable: error mean cm",
            "median",
            "max",
            "elongation deg",
            "unreachable: error mean cm",
            "min",
        ],
        rows,
    )


EXPERIMENT = Experiment("E1", "Helix, KUKA iiwa 14 [S, section 5.2]", studies, report)
