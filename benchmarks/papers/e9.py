"""E9: four trajectories of the EOD arm, [L] section 4.3.2."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.papers import published
from benchmarks.papers.document import Document, slashed
from benchmarks.papers.experiment import Experiment, Results, Study, thinned
from benchmarks.papers.li_paths import path_case
from benchmarks.papers.li_series import LEAST, li_series
from benchmarks.papers.li_tables import comparison
from benchmarks.papers.plots import boxes, curves, new_figure, paths_3d
from benchmarks.papers.rows import Table
from benchmarks.papers.series import PLANNER, Series
from ikplan.kinematics.forward import forward_batch

__all__ = ["EXPERIMENT"]

N, T = 60, 100
NAMES = ("1", "2", "3", "4")
PAPER = li_series(N, T)
WARM = [
    replace(
        s,
        name=f"{s.name}, warm",
        params={**s.params, "warm": "individual"},
        tracks=True,
        paper=False,
        max_runs=5,
    )
    for s in PAPER
]
OWN = Series("ikplan, greedy", PLANNER, params={"elongation": "tracking"}, paper=False, max_runs=1)
SIDE = [replace(s, max_runs=5) for s in PAPER if s.name in ("BODE-CS", "DE/best/1", "CS")]


def studies(thin: int) -> list[Study]:
    """Return the four trajectories, the impossible one, and two with the printed matrix."""
    made = [Study(path_case(name), [*PAPER, *WARM, OWN, LEAST]) for name in NAMES]
    made.append(Study(path_case("3+"), [*SIDE, OWN]))
    made += [Study(path_case(name, printed=True), [*SIDE, OWN]) for name in NAMES]
    return [Study(thinned(study.case, thin), study.series) for study in made]


def _short(table: Table) -> list[object]:
    """Position mean / median / 95 % / max, angle mean, largest fitness."""
    if len(table) == 0:
        return [None, None, None]
    p = 1e3 * table["eps_p"]
    return [
        slashed(
            [float(p.mean()), float(np.median(p)), float(np.quantile(p, 0.95)), float(p.max())]
        ),
        slashed([float(table["delta_R"].mean()), float(table["theta_deg"].mean())]),
        slashed([float(table["f"].mean()), float(table["f"].max())]),
    ]


def _trajectory(study: Study, results: Results, document: Document) -> None:
    case = study.case
    given = published.LI_TABLE_9[case.name.removeprefix("E9-")]
    document.heading(f"{case.name}: {case.title}", 3)
    document.say(
        f"{int(case.reachable.sum())} of {case.count} poses can be reached within the limits "
        "(closed form); position mm: mean / median / 95 % / max; angle: mean Delta R / theta deg; "
        "fitness: mean / max."
    )
    rows = []
    for series in study.series:
        table = results.tables[case.name, series.name]
        inside, outside = table.where(case.reachable), table.where(~case.reachable)
        exact = series.name == LEAST.name
        rows.append(
            [
                series.name,
                slashed(given.get(series.name)),
                *_short(inside),
                *([None, None, None] if exact else _short(outside)),
                None if exact else table.grid("elongation_deg")[:, 1:].mean(),
                table["n_eval"].mean(),
                1e3 * table["cpu_seconds"].mean(),
            ]
        )
    document.table(
        [
            "series",
            "published max mm / fitness",
            "reachable: position mm",
            "angle",
            "fitness",
            "unreachable: position mm",
            "angle",
            "fitness",
            "elongation deg",
            "evaluations",
            "ms",
        ],
        rows,
    )
    comparison(case.name, PAPER, results, document)


def _figures(main: list[Study], results: Results, document: Document) -> None:
    for column, factor, label, name, what in (
        ("eps_p", 1e3, "position error [mm]", "E9-positions", "position errors (Figure 14)"),
        ("f", 1.0, "fitness [mm]", "E9-fitness", "fitness (Figure 15)"),
    ):
        figure, axes = new_figure(13.0, 3.4, 4)
        for ax, study in zip(axes, main, strict=True):
            data = {s.name: factor * results.tables[study.case.name, s.name][column] for s in PAPER}
            boxes(ax, data, label, log=True)
            ax.set_title(study.case.title, fontsize=9)
        document.figure(figure, name, f"E9: {what}, reachable and unreachable poses")
    figure, axes = new_figure(13.0, 3.2, 4)
    for i, (ax, study) in enumerate(zip(axes, main, strict=True)):
        lines = {
            s.name: np.exp(np.log(results.curves[study.case.name, s.name][:, 0]).mean(axis=0))
            for s in PAPER
        }
        label = "fitness [mm], geometric mean" if i == 0 else ""
        curves(ax, lines, "iteration", label, log=True, legend=i == 0)
        ax.set_title(study.case.title, fontsize=9)
    document.figure(figure, "E9-convergence", "E9: convergence (Figure 16)")
    panels = []
    for study in main:
        paths = {"asked": 1e3 * study.case.p}
        for name in ("DE/best/1", "BODE-CS"):
            q = results.tables[study.case.name, name].q[: study.case.count].copy()
            paths[name] = 1e3 * forward_batch(study.case.arm.chain, q)[1]
        panels.append((study.case.title, paths))
    document.figure(paths_3d(panels, 13.0, 3.4, "mm"), "E9-paths", "E9: paths (Figures 17-20)")


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    document.say(
        "200 points each, N = 60, T = 100, cold start at each point, at most 5 runs; `warm`: at "
        "most 2 runs, individual 0 is the solution of the point before. Eq. 47 is no rotation (its "
        "determinant is 0.134): pattern A of its possible repairs is used, and not one repair "
        "makes all points reachable within the limits. Reachable and unreachable points are apart."
    )
    main = studies[: len(NAMES)]
    for study in main:
        _trajectory(study, results, document)
    _figures(main, results, document)
    document.heading("Trajectory 3 with x = +500 mm, as printed", 3)
    rows: list[list[object]] = []
    study = studies[len(NAMES)]
    for series in study.series:
        p = 1e3 * results.tables[study.case.name, series.name]["eps_p"]
        rows.append([series.name, p.min(), p.mean(), p.max()])
    document.say("No point can be reached; position errors in mm:")
    document.table(["series", "min", "mean", "max"], rows)
    document.heading("Eq. 47 as printed", 3)
    document.say("Its distance from any rotation puts a floor of 0.0431 under the fitness.")
    rows = []
    for study in studies[len(NAMES) + 1 :]:
        for series in study.series:
            table = results.tables[study.case.name, series.name]
            p = 1e3 * table["eps_p"]
            f = table["f"]
            row = [study.case.title, series.name, p.mean(), p.max(), f.min(), f.mean(), f.max()]
            rows.append(row)
    document.table(
        ["trajectory", "series", "position mm mean", "max", "fitness min", "mean", "max"], rows
    )


EXPERIMENT = Experiment("E9", "Four trajectories, EOD arm [L, section 4.3.2]", studies, report)
