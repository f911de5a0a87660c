"""The tables of E1."""

from __future__ import annotations

import numpy as np

from benchmarks.papers import published
from benchmarks.papers.document import Document, slashed
from benchmarks.papers.e1_series import CLOUD, IK_BA, LEAST, MISS, PAPER, UNIFORM, per_run
from benchmarks.papers.experiment import Results, Study
from benchmarks.papers.series import OPTIMUM, PLANNER
from benchmarks.papers.statistics import adjusted, anova, over_runs, summary

__all__ = ["analysis", "beside_published", "overview", "ranking", "split"]

COLUMNS = (("eps_p", "position error", 100.0), ("elongation_deg", "elongation", 1.0))


def overview(study: Study, results: Results, document: Document) -> None:
    """One line a series: error, orientation, elongation, cost, limits."""
    case = study.case
    best = results.tables[case.name, LEAST.name]
    least = float(best.grid("elongation_deg")[0].sum())
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


def beside_published(study: Study, results: Results, document: Document) -> None:
    """Table 3: per run (the mean over 20 points), published beside ours, and per point."""
    case = study.case
    for column, title, factor in (
        ("eps_p", "Position error, cm", 100.0),
        ("elongation_deg", "Joint variation, deg", 1.0),
    ):
        document.say(f"{title}: mean / median / std (ddof 1) / max / min.")
        rows = []
        for series in [*PAPER, UNIFORM, CLOUD]:
            table = results.tables[case.name, series.name]
            runs = summary(per_run(table, column, factor))
            points = summary(factor * table.grid(column).mean(axis=0))
            given = published.SLIM_TABLE_3[column].get(series.name)
            rows.append([series.name, slashed(given), slashed(runs), slashed(points)])
        count = results.runs
        document.table(["series", "published", f"ours, {count} runs", "ours, 20 points"], rows)


def ranking(study: Study, results: Results, document: Document) -> None:
    """The published order beside ours, and whether neighbours are told apart."""
    names = [s.name for s in PAPER]
    for column, title, factor in COLUMNS:
        given = published.SLIM_TABLE_3[column]
        theirs = sorted(given, key=lambda name: given[name][0])
        values = {n: per_run(results.tables[study.case.name, n], column, factor) for n in names}
        ours = sorted(names, key=lambda name: float(values[name].mean()))
        pairs = [(a, b) for i, a in enumerate(ours) for b in ours[i + 1 :]]
        tests = [over_runs(values[a], values[b]) for a, b in pairs]
        compared = dict(zip(pairs, adjusted(tests), strict=True))
        rows: list[list[object]] = []
        for i, name in enumerate(ours):
            row: list[object] = [str(i + 1), theirs[i], name, float(values[name].mean())]
            if i + 1 < len(ours):
                test = compared[name, ours[i + 1]]
                row += [test.p, f"{test.effect:.2f} ({test.low:.2f} to {test.high:.2f})"]
            else:
                row += [None, None]
            rows.append(row)
        document.say(
            f"Order by mean {title}, with the test of each against the next (Mann-Whitney over the "
            "runs, Holm over all 15 pairs, A12 with its interval)."
        )
        document.table(["rank", "published", "ours", "mean", "p against the next", "A12"], rows)


def analysis(study: Study, results: Results, document: Document) -> None:
    """Tables 4-6 and what unequal variances ask for; IK-BA against each."""
    case = study.case
    rows = []
    for column, title, factor in (*COLUMNS, ("cpu_seconds", "time", 1.0)):
        given = published.SLIM_ANOVA[column]
        rows.append([f"{title}, published", "5, 114", *given, None, None, None])
        groups = [per_run(results.tables[case.name, s.name], column, factor) for s in PAPER]
        a = anova(groups)
        ours = [a.ss_between, a.ss_within, a.F, a.p, a.levene, a.welch, a.kruskal]
        rows.append([f"{title}, ours", f"{a.df[0]}, {a.df[1]}", *ours])
    head = ["quantity", "df", "SS between", "SS within", "F", "p"]
    document.table([*head, "Levene p", "Welch p", "Kruskal p"], rows)
    document.say(
        "Welch: the Alexander-Govern test. Time: processor time of one solve; the published is of "
        "MATLAB, and only ratios compare."
    )
    document.say(
        "IK-BA against each: Mann-Whitney over the runs, adjusted by Holm within the column; A12, "
        "the probability that a run of IK-BA has the smaller value, with its interval."
    )
    others = [s for s in study.series if s.method not in (PLANNER, OPTIMUM) and s != IK_BA]
    tests = {}
    for column, _, _ in COLUMNS:
        own = per_run(results.tables[case.name, IK_BA.name], column)
        tests[column] = adjusted(
            [over_runs(own, per_run(results.tables[case.name, s.name], column)) for s in others]
        )
    pairs: list[list[object]] = []
    for i, series in enumerate(others):
        row: list[object] = [series.name]
        for column, _, _ in COLUMNS:
            test = tests[column][i]
            row += [test.p, f"{test.effect:.2f} ({test.low:.2f} to {test.high:.2f})"]
        pairs.append(row)
    document.table(["IK-BA against", "error p", "A12", "variation p", "A12"], pairs)


def split(study: Study, results: Results, document: Document) -> None:
    """Reachable and unreachable points apart."""
    case = study.case
    document.say(
        f"{int(case.reachable.sum())} points can be reached; points "
        f"{', '.join(str(k + 1) for k in np.flatnonzero(~case.reachable))} cannot. The "
        "project's planner refuses such a path and names the points; its rows here are its path "
        "through the others, with the closest configuration at each of these."
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
                100.0 * outside["eps_p"].max(),
            ]
        )
    head = ["series", "reachable: error mean cm", "median", "max", "elongation deg"]
    document.table([*head, "unreachable: error mean cm", "min", "max"], rows)
