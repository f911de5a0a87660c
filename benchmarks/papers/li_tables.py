"""Tables and tests that E7, E8 and E9 share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.document import Document, slashed
from benchmarks.papers.experiment import Results
from benchmarks.papers.rows import Table
from benchmarks.papers.series import Series
from benchmarks.papers.statistics import average_ranks, friedman, holm, paired

__all__ = ["by_target", "comparison", "pose_table", "solved"]

Array = NDArray[np.float64]


def solved(table: Table) -> float:
    """Return the share of solves within 0.1 mm and 0.1 deg."""
    return float(((table["eps_p"] <= 1e-4) & (table["theta_deg"] <= 0.1)).mean())


def by_target(table: Table, column: str) -> Array:
    """Return the mean over the runs of each target."""
    means: Array = table.grid(column).mean(axis=0)
    return means


def spread(values: Array) -> str:
    """Return mean / median / std / 95 % quantile / max."""
    return slashed(
        [
            float(values.mean()),
            float(np.median(values)),
            float(values.std(ddof=1)),
            float(np.quantile(values, 0.95)),
            float(values.max()),
        ]
    )


def pose_table(
    case: str,
    series: Sequence[Series],
    results: Results,
    document: Document,
    given: Mapping[str, tuple[float, float]] | None = None,
) -> None:
    """Add one line a series: position, orientation, fitness, cost."""
    rows = []
    for s in series:
        table = results.tables[case, s.name]
        millimetres = 1e3 * table["eps_p"]
        published = (given or {}).get(s.name)
        run_maxima = 1e3 * table.grid("eps_p").max(axis=1)
        rows.append(
            [
                s.name,
                slashed(published),
                slashed([float(run_maxima.mean()), float(table.grid("f").max(axis=1).mean())]),
                spread(millimetres),
                100.0 * (millimetres > 0.1).mean(),
                slashed([float(table["delta_R"].mean()), float(table["theta_deg"].mean())]),
                spread(table["f"]),
                100.0 * solved(table),
                table["n_eval"].mean(),
                1e3 * table["cpu_seconds"].mean(),
                100.0 * (table["violations"] > 0).mean(),
            ]
        )
    document.table(
        [
            "series",
            "published max: mm / fitness",
            "ours: mean of the runs' max",
            "position mm: mean / median / std / 95 % / max",
            "% > 0.1 mm",
            "Delta R / theta deg, mean",
            "fitness: mean / median / std / 95 % / max",
            "% pose solved",
            "evaluations",
            "ms",
            "% outside limits",
        ],
        rows,
    )


def comparison(case: str, series: Sequence[Series], results: Results, document: Document) -> None:
    """Compare the first series with each other, paired by target."""
    columns = ("eps_p", "f")
    first, others = series[0], series[1:]
    tests: dict[str, list[tuple[float, float]]] = {}
    ranks: dict[str, dict[str, float]] = {}
    p_all: dict[str, float] = {}
    for column in columns:
        data = {s.name: by_target(results.tables[case, s.name], column) for s in series}
        tests[column] = [paired(data[first.name], data[s.name]) for s in others]
        ranks[column] = average_ranks(data)
        p_all[column] = friedman(data)
    adjusted = {c: holm([p for p, _ in tests[c]]) for c in columns}
    rows: list[list[object]] = [
        [first.name, ranks["eps_p"][first.name], None, None, ranks["f"][first.name], None, None]
    ]
    for i, s in enumerate(others):
        row: list[object] = [s.name]
        for c in columns:
            row += [ranks[c][s.name], adjusted[c][i], tests[c][i][1]]
        rows.append(row)
    document.say(
        f"Average ranks over the targets (mean over the runs of each), and {first.name} against "
        "each other: Wilcoxon p (Holm), matched-pairs rank-biserial effect, -1 where "
        f"{first.name} is smaller at every target. Friedman: p = {p_all['eps_p']:.2g} for the "
        f"position error, {p_all['f']:.2g} for the fitness."
    )
    document.table(["series", "position rank", "p", "effect", "fitness rank", "p", "effect"], rows)
