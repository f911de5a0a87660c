"""E9: four trajectories of the EOD arm, [L] section 4.3.2."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import published
from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study, thinned
from benchmarks.papers.li_claims import beats, per_cent, run_maximum, solved_share
from benchmarks.papers.li_paths import path_case
from benchmarks.papers.li_series import LEAST, li_series
from benchmarks.papers.li_tables import SPREAD, comparison, pose_tables, spread
from benchmarks.papers.plots import boxes, curves, legend_below, new_figure, paths_3d
from benchmarks.papers.series import PLANNER, Series, references
from ikplan.kinematics.forward import forward_batch

__all__ = ["EXPERIMENT"]

N, T = 60, 100
NAMES = ("1", "2", "3", "4")
PAPER = li_series(N, T)
REFERENCES = references(N, T)
WARM = [
    replace(
        s,
        name=f"{s.name}, warm",
        params={**s.params, "warm": "individual"},
        tracks=True,
        paper=False,
    )
    for s in PAPER
]
OWN = Series("ikplan, greedy", PLANNER, params={"elongation": "tracking"}, paper=False, max_runs=1)
SIDE = [*(s for s in PAPER if s.name in ("BODE-CS", "DE/best/1", "CS")), OWN]


def studies(thin: int) -> list[Study]:
    """Return the four trajectories, the impossible one, and two with the printed matrix."""
    main = [*PAPER, *REFERENCES, *WARM, OWN, LEAST]
    made = [Study(path_case(name), main) for name in NAMES]
    made.append(Study(path_case("3+"), SIDE))
    made += [Study(path_case(name, printed=True), SIDE) for name in NAMES]
    return [Study(thinned(study.case, thin), study.series) for study in made]


def _groups(study: Study) -> list[tuple[str, NDArray[np.bool_]]]:
    """The reachable and the unreachable targets, which are never averaged together."""
    mask = study.case.reachable
    return [(n, m) for n, m in (("reachable", mask), ("unreachable", ~mask)) if m.any()]


def _trajectory(study: Study, results: Results, document: Document) -> None:
    case = study.case
    given = published.LI_TABLE_9[case.name.removeprefix("E9-")]
    document.heading(f"{case.name}: {case.title}", 3)
    document.say(
        f"{int(case.reachable.sum())} of {case.count} poses can be reached within the limits "
        "(closed form). The published maxima are over all points."
    )
    for title, mask in _groups(study):
        document.heading(f"{case.name}, {int(mask.sum())} {title} points", 4)
        inside = title == "reachable"
        series = [s for s in study.series if inside or s.name != LEAST.name]
        pose_tables(case.name, series, results, document, given, mask)
        with document.details(f"Joint motion between neighbours and tests, {title} points"):
            moves = mask & (np.arange(case.count) > 0)
            if moves.any():
                document.say("Elongation from the point before, deg:")
                tables = {s.name: results.tables[case.name, s.name].where(moves) for s in series}
                rows = [[name, *spread(t["elongation_deg"])] for name, t in tables.items()]
                document.table(["series", *SPREAD], rows)
            comparison(case.name, [*PAPER, *REFERENCES], results, document, mask)


def _figures(main: list[Study], results: Results, document: Document) -> None:
    for column, factor, label, name, what in (
        ("eps_p", 1e3, "position error [mm]", "E9-positions", "position errors (Figure 14)"),
        ("f", 1.0, "fitness [mm]", "E9-fitness", "fitness (Figure 15)"),
    ):
        figure, axes = new_figure(13.0, 6.4, 4, 2, same_y=True)
        for i, study in enumerate(main):
            for row, (title, mask) in enumerate(_groups(study)):
                ax = axes[4 * row + i]
                tables = {
                    s.name: results.tables[study.case.name, s.name] for s in [*PAPER, *REFERENCES]
                }
                data = {n: factor * t.where(mask)[column] for n, t in tables.items()}
                boxes(ax, data, label if i == 0 else "", log=True)
                ax.set_title(f"{study.case.title}, {title}", fontsize=9)
        document.figure(figure, name, f"E9: {what}, reachable and unreachable points apart")
    figure, axes = new_figure(13.0, 6.2, 4, 2, same_y=True)
    for i, study in enumerate(main):
        for row, (title, _) in enumerate(_groups(study)):
            lines = {
                s.name: np.exp(
                    np.log(results.curves[study.case.name, s.name][:, 3 * row]).mean(axis=0)
                )
                for s in [*PAPER, *REFERENCES]
            }
            label = "fitness [mm], geometric mean" if i == 0 else ""
            ax = axes[4 * row + i]
            curves(ax, lines, "iteration", label, log=True)
            ax.set_title(f"{study.case.title}, {title}", fontsize=9)
    legend_below(figure, axes[0])
    document.figure(
        figure, "E9-convergence", "E9: convergence (Figure 16), reachable and unreachable apart"
    )
    panels = []
    for study in main:
        paths = {"asked": 1e3 * study.case.p}
        for name in ("DE/best/1", "BODE-CS"):
            q = results.tables[study.case.name, name].q[: study.case.count].copy()
            paths[name] = 1e3 * forward_batch(study.case.arm.chain, q)[1]
        panels.append((study.case.title, paths))
    document.figure(
        paths_3d(panels, 13.0, 3.4, "mm"), "E9-paths", "E9: paths of the first run (Figures 17-20)"
    )


def _claims(main: list[Study], results: Results, document: Document) -> None:
    for study in main:
        case = study.case
        given = published.LI_TABLE_9[case.name.removeprefix("E9-")]["BODE-CS"]
        table = results.tables[case.name, "BODE-CS"]
        run_maximum(
            f"E9, {case.title}: largest position error of BODE-CS over the points of a run",
            given[0],
            table,
            document,
            200,
        )
        inside = table.where(case.reachable)
        met = solved_share(inside)
        own = solved_share(results.tables[case.name, OWN.name].where(case.reachable))
        document.claim(
            f"E9, {case.title}: BODE-CS solves the orientation where the pose can be reached",
            "not given",
            f"median {np.median(inside['theta_deg']):.0f} deg; poses solved {per_cent(met)}; by "
            f"the project's planner {per_cent(own)}",
            met.n,
            "bootstrap of the share of poses within 0.1 mm and 0.1 deg",
            HOLDS if met.low > 0.95 else FAILS if met.high < 0.95 else UNDECIDED,
        )
        beats(
            f"E9, {case.title}, reachable points",
            case.name,
            "eps_p",
            "position error",
            PAPER,
            REFERENCES,
            results,
            document,
            case.reachable,
        )


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    document.say(
        "200 points each, N = 60, T = 100, cold start at each point; `warm`: "
        "individual 0 is the solution of the point before. "
        "The tests are over the points, by the medians of each. Eq. 47 is no rotation (its "
        "determinant is 0.134): pattern A of its possible repairs is used, and not one repair "
        "makes all points reachable within the limits. Reachable and unreachable points are apart. "
        "Where a pose is out of reach the searches with this weight give up the orientation, the "
        "project's planner (one run: it solves to 1e-9 m) tells how far the arm gets with the "
        "orientation held: its rows there are another question's answer."
    )
    main = studies[: len(NAMES)]
    for study in main:
        _trajectory(study, results, document)
    _figures(main, results, document)
    _claims(main, results, document)
    document.heading("Trajectory 3 with x = +500 mm, as printed", 3)
    rows: list[list[object]] = []
    study = studies[len(NAMES)]
    for series in study.series:
        p = 1e3 * results.tables[study.case.name, series.name]["eps_p"]
        rows.append([series.name, p.min(), p.mean(), p.max()])
    document.say("No point can be reached; position errors in mm:")
    document.table(["series", "min", "mean", "max"], rows)
    document.heading("Eq. 47 as printed", 3)
    document.say(
        "Its distance from any rotation puts a floor of 0.0431 under the fitness. Next to no point "
        "can be met with the rotation nearest to it, which is what the project's planner takes."
    )
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
