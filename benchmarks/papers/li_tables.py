"""Tables and tests that E7, E8 and E9 share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.document import Document, slashed
from benchmarks.papers.experiment import Results
from benchmarks.papers.rows import Table
from benchmarks.papers.series import Series
from benchmarks.papers.statistics import (
    Comparison,
    adjusted,
    average_ranks,
    friedman,
    over_targets,
)

__all__ = ["SPREAD", "Targets", "by_target", "comparison", "pose_tables", "solved", "spread"]

Array = NDArray[np.float64]
Targets = NDArray[np.bool_] | None
"""One flag a target: those that a table is about; None: all of them."""


def solved(table: Table) -> float:
    """Return the share of solves within 0.1 mm and 0.1 deg."""
    return float(((table["eps_p"] <= 1e-4) & (table["theta_deg"] <= 0.1)).mean())


def of_targets(table: Table, targets: Targets) -> Table:
    """Return the rows of some targets."""
    return table if targets is None else table.where(targets)


def by_target(table: Table, column: str, targets: Targets = None) -> Array:
    """Return the median over the runs of each target: errors spread over ten decades."""
    medians: Array = np.median(of_targets(table, targets).grid(column), axis=0)
    return medians


def spread(values: Array) -> list[object]:
    """Return mean, median, standard deviation, least, 95 % quantile and largest."""
    deviation = float(values.std(ddof=1)) if len(values) > 1 else None
    quantile = float(np.quantile(values, 0.95))
    middle = float(np.median(values))
    return [float(values.mean()), middle, deviation, values.min(), quantile, values.max()]


SPREAD = ("mean", "median", "std", "min", "95 %", "max")


def pose_tables(
    case: str,
    series: Sequence[Series],
    results: Results,
    document: Document,
    given: Mapping[str, tuple[float, float]] | None = None,
    targets: Targets = None,
) -> None:
    """Add a table of what matters, one line a series, and the whole spread of each quantity."""
    rows = []
    tables = {s.name: of_targets(results.tables[case, s.name], targets) for s in series}
    for name, table in tables.items():
        millimetres = 1e3 * table["eps_p"]
        run_maxima = [
            1e3 * float(table.grid("eps_p").max(axis=1).mean()),
            float(table.grid("f").max(axis=1).mean()),
        ]
        rows.append(
            [
                name,
                slashed((given or {}).get(name)),
                slashed(run_maxima),
                float(np.median(millimetres)),
                float(np.quantile(millimetres, 0.95)),
                100.0 * (millimetres > 0.1).mean(),
                float(np.median(table["theta_deg"])),
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
            "ours, mean of the runs' max",
            "position median mm",
            "95 %",
            "% > 0.1 mm",
            "theta median deg",
            "% pose solved",
            "evaluations",
            "ms",
            "% outside limits",
        ],
        rows,
    )
    with document.details("Spread of position, orientation and fitness over all solves"):
        for column, title, factor in (
            ("eps_p", "Position error, mm", 1e3),
            ("theta_deg", "Orientation error theta, deg", 1.0),
            ("delta_R", "Orientation error Delta R", 1.0),
            ("f", "Fitness, mm", 1.0),
        ):
            document.say(f"{title}:")
            lines = [[name, *spread(factor * table[column])] for name, table in tables.items()]
            document.table(["series", *SPREAD], lines)


def comparison(
    case: str,
    series: Sequence[Series],
    results: Results,
    document: Document,
    targets: Targets = None,
) -> None:
    """Compare the first series with each other, paired by target."""
    columns = ("eps_p", "f")
    first, others = series[0], series[1:]
    tests: dict[str, list[Comparison]] = {}
    ranks: dict[str, dict[str, float]] = {}
    p_all: dict[str, float] = {}
    for column in columns:
        data = {s.name: by_target(results.tables[case, s.name], column, targets) for s in series}
        tests[column] = adjusted([over_targets(data[first.name], data[s.name]) for s in others])
        ranks[column] = average_ranks(data)
        p_all[column] = friedman(data)
    rows: list[list[object]] = [
        [first.name, ranks["eps_p"][first.name], None, None, ranks["f"][first.name], None, None]
    ]
    for i, s in enumerate(others):
        row: list[object] = [s.name]
        for c in columns:
            test = tests[c][i]
            row += [
                ranks[c][s.name],
                test.p,
                f"{test.effect:.2f} ({test.low:.2f} to {test.high:.2f})",
            ]
        rows.append(row)
    document.say(
        f"Average ranks over the targets (median over the runs of each), and {first.name} against "
        "each other: Wilcoxon over the targets, Holm over the column; effect: (1 - rank-biserial) "
        f"/ 2, 1 where {first.name} is smaller at every target. Friedman: p = {p_all['eps_p']:.2g} "
        f"for the position error, {p_all['f']:.2g} for the fitness."
    )
    document.table(["series", "position rank", "p", "effect", "fitness rank", "p", "effect"], rows)
