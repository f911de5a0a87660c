"""S1 and S2: what IK-BA is for, by the distance of the start and by the number of joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED, short, told
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Results, Study, thinned
from benchmarks.papers.li_tables import by_target
from benchmarks.papers.plots import legend_below, new_figure
from benchmarks.papers.rows import Table
from benchmarks.papers.series import PLANNER, Series
from benchmarks.papers.statistics import adjusted, estimate, over_targets
from benchmarks.papers.sweep_cases import DIMENSIONS, DISTANCES, dimension_case, distance_case

__all__ = ["OWN", "RIVALS", "RUNS", "SEARCHES", "dimensions", "distances", "report_sweep"]

N, T = 50, 200
SEARCHES = [
    Series("IK-BA", "ik-ba", N, T, {"preset": "bat-code"}),
    Series("IK-BA, uniform noise", "ik-ba", N, T, {"preset": "slim"}),
    Series("IK-BA, cloud", "ik-ba", N, T, {"preset": "bat-code", "warm": "cloud"}),
    Series("DE, cloud", "de-rand-1", N, T, {"preset": "slim", "warm": "cloud"}),
    Series("PSO, cloud", "pso", N, T, {"preset": "slim-permuted", "warm": "cloud"}),
    Series("BODE-CS, warm", "bode-cs", N, 182, {"warm": "individual"}),
    Series("CMA-ES, cloud", "cma-es", N, T, {"warm": "cloud"}),
    Series("L-SHADE, cloud", "l-shade", N, T, {"warm": "cloud"}),
    Series("CMA-ES, cold", "cma-es", N, T),
]
"""All but the last begin at the start configuration; about 10,000 evaluations each."""
OWN = Series("ikplan", PLANNER, params={"elongation": "independent"}, paper=False, max_runs=1)
RIVALS = [s for s in SEARCHES if "IK-BA" not in s.name and s.name != "CMA-ES, cold"]
RUNS = 5
"""Runs of each search: the targets are what the tests are over."""
SERIES = [*(replace(s, max_runs=RUNS) for s in SEARCHES), OWN]


def distances(thin: int) -> list[Study]:
    """Return a case a distance."""
    step = min(thin, 4)
    return [Study(thinned(distance_case(degrees), step), SERIES) for degrees in DISTANCES]


def dimensions(thin: int) -> list[Study]:
    """Return a case a number of joints."""
    step = min(thin, 4)
    return [Study(thinned(dimension_case(dof), step), SERIES) for dof in DIMENSIONS]


def report_sweep(
    name: str, axis: str, values: Sequence[int], results: Results, document: Document
) -> None:
    """Write the table, the figure and the claims of a sweep.

    Args:
        name: S1 or S2; cases are named "S1-5" and so on.
        axis: What is swept, with its unit.
        values: Its values.
        results: The rows.
        document: The report.
    """
    rows: list[list[object]] = []
    errors: dict[str, list[float]] = {}
    motions: dict[str, list[float]] = {}
    for series in [*SEARCHES, OWN]:
        for value in values:
            table = results.tables[f"{name}-{value}", series.name]
            motion = estimate(table.grid("elongation_deg"))
            millimetres = 1e3 * table["eps_p"]
            errors.setdefault(series.name, []).append(float(np.median(millimetres)))
            motions.setdefault(series.name, []).append(motion.value)
            quantile = float(np.quantile(millimetres, 0.95))
            rows.append(
                [
                    series.name,
                    value,
                    float(np.median(millimetres)),
                    quantile,
                    told(motion),
                    table["n_eval"].mean(),
                ]
            )
    document.table(
        ["series", axis, "error median mm", "95 % mm", "joint motion mean deg", "evaluations"], rows
    )
    figure, axes = new_figure(10.0, 3.8, 2)
    for label in errors:
        axes[0].semilogy(values, np.maximum(errors[label], 1e-12), "o-", label=label, markersize=3)
        axes[1].plot(values, motions[label], "o-", label=label, markersize=3)
    axes[0].set_ylabel("position error, median [mm]", fontsize=9)
    axes[1].set_ylabel("joint motion, mean [deg]", fontsize=9)
    for ax in axes:
        ax.set_xlabel(axis, fontsize=9)
    legend_below(figure, axes[0])
    document.figure(figure, f"{name}-sweep", f"{name}: error and joint motion over the {axis}")
    for own, column, what in (
        ("IK-BA", "elongation_deg", "joint motion"),
        ("IK-BA, cloud", "elongation_deg", "joint motion"),
        ("IK-BA", "eps_p", "error"),
    ):
        _claims(name, axis, values, own, column, what, results, document)


def _claims(
    name: str,
    axis: str,
    values: Sequence[int],
    own: str,
    column: str,
    what: str,
    results: Results,
    document: Document,
) -> None:
    """Whether IK-BA has the smaller value than each other search that begins at the start."""
    title = f"{own.removesuffix(', cloud')}{', begun around the start,' if 'cloud' in own else ''}"
    for value in values:
        tables = {n: results.tables[f"{name}-{value}", n] for n in [own, *(s.name for s in RIVALS)]}
        medians = {n: by_target(table, column) for n, table in tables.items()}
        tests = adjusted([over_targets(medians[own], medians[s.name]) for s in RIVALS])
        factor, unit = (1e3, "mm") if column == "eps_p" else (1.0, "deg")
        order = sorted(medians, key=lambda n: float(np.median(medians[n])))
        figures = ", ".join(f"{n} {short(factor * float(np.median(medians[n])))}" for n in order)
        lost = [s.name for s, t in zip(RIVALS, tests, strict=True) if t.second_is_smaller]
        worst = min(tests, key=lambda t: t.effect)
        document.claim(
            f"{name}, {axis} {value}: {title} has the smallest {what} of what begins at the start",
            "not done",
            f"medians {figures} {unit}"
            + (f"; {', '.join(lost)} smaller" if lost else "")
            + (_means(own, column, tables) if column == "elongation_deg" else ""),
            f"{worst.n}, medians over the runs",
            f"{worst.test}, Holm over {len(tests)}: worst {worst.told()}",
            HOLDS if all(t.first_is_smaller for t in tests) else FAILS if lost else UNDECIDED,
        )


def _means(own: str, column: str, tables: Mapping[str, Table]) -> str:
    """Return the mean of a series and of the rival with the least: far branches weigh in these."""
    least = min((n for n in tables if n != own), key=lambda n: float(tables[n][column].mean()))
    figures = (f"{n} {told(estimate(tables[n].grid(column)))}" for n in (own, least))
    return f"; means {' and '.join(figures)}"
