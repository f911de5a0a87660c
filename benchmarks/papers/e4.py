"""E4: four trajectories on the MH5, [K] sections 3.6 to 4.1."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from benchmarks.papers import published
from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED, short, smallest, told
from benchmarks.papers.document import Document, slashed
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.plots import boxes, new_figure, paths_3d
from benchmarks.papers.series import OPTIMUM, PLANNER, Series, references
from benchmarks.papers.statistics import (
    adjusted,
    estimate,
    friedman,
    over_targets,
    share,
)
from benchmarks.papers.trajectories import TRAJECTORIES, tracking_case
from ikplan.kinematics.forward import forward_batch

__all__ = ["CONTROLS", "EXPERIMENT", "PAPER", "REFERENCES", "warm"]

Array = NDArray[np.float64]

N, T = 60, 100
PAPER = [
    Series("BAT", "bat", N, T),
    Series("GSA", "gsa", N, T),
    Series("PSO", "pso", N, T, {"preset": "kanagaraj"}),
    Series("WOA", "woa", N, T),
]
SHARED = {"reading": "shared", "A_low": 1.0, "A_high": 1.0, "r0_low": 1.0, "r0_high": 1.0}
"""Circulating bat code, with the paper's frequencies, omega and gamma."""
CONTROLS = [
    Series("BAT, eps a vector", "bat", N, T, {"noise": "component"}, paper=False),
    Series("BAT, decay/iteration", "bat", N, T, {"decay": "iteration"}, paper=False),
    Series("BAT, shared", "bat", N, T, SHARED, paper=False),
    Series("GSA, drawn anew", "gsa", N, T, {"bounds": "resample"}, paper=False),
    Series("GSA, alpha 20", "gsa", N, T, {"alpha": 20.0}, paper=False),
    Series("GSA, alpha 20, drawn anew", "gsa", N, T, {"alpha": 20.0, "bounds": "resample"}, False),
    Series("PSO, vector draws", "pso", N, T, {"preset": "kanagaraj", "draws": "component"}, False),
    Series("PSO, no v_max", "pso", N, T, {"preset": "kanagaraj", "v_max": 0.0}, paper=False),
    Series("WOA, b 1", "woa", N, T, {"b": 1.0}, paper=False),
    Series("WOA, literal", "woa", N, T, {"literal": True}, paper=False),
]
REFERENCES = references(N, T)
NAMES = [s.name for s in PAPER]
SHOWN = ("BAT, shared", "GSA, alpha 20")
CLOUD = Series("BAT, cloud", "bat", N, T, {"warm": "cloud"}, paper=False)
GREEDY = Series("ikplan, greedy", PLANNER, params={"elongation": "tracking"}, paper=False)
WHOLE = Series("ikplan", PLANNER, params={"elongation": "global"}, paper=False)
LEAST = Series("least motion", OPTIMUM, paper=False)


def warm(series: Series, how: str) -> Series:
    """Return the series started warm or cold."""
    return replace(series, params={**series.params, "warm": how})


def studies(_thin: int) -> list[Study]:
    """Return each trajectory warm (E4a), cold (E4b), and warm with the URDF's limits (E4u)."""
    every = [*PAPER, *CONTROLS, *REFERENCES]
    made = []
    for name in TRAJECTORIES:
        hot = [*(warm(s, "individual") for s in every), CLOUD, WHOLE, GREEDY, LEAST]
        made.append(Study(tracking_case(name, "E4a"), hot))
    for name in TRAJECTORIES:
        cold = [warm(s, "cold") for s in every]
        made.append(Study(tracking_case(name, "E4b"), [*cold, WHOLE, LEAST]))
    for name in TRAJECTORIES:
        hot = [*(warm(s, "individual") for s in [*PAPER, *REFERENCES]), WHOLE, LEAST]
        made.append(Study(tracking_case(name, "E4u", urdf_limits=True), hot))
    return made


def _point_means(results: Results, case: str, series: str) -> Array:
    """Mean error of each point over the runs, in 1e-4 m, as Table 4 has it."""
    means: Array = 1e4 * results.tables[case, series].grid("eps_p").mean(axis=0)
    return means


def _table_5(studies: list[Study], results: Results, document: Document) -> None:
    rows = []
    for study in studies:
        given = published.KANAGARAJ_TABLE_5[study.case.title]
        for series in study.series:
            v = _point_means(results, study.case.name, series.name)
            geometric = float(stats.gmean(np.maximum(v, 1e-14)))
            ours = [geometric, float(np.median(v)), float(v.std()), v.min(), v.max()]
            table = results.tables[study.case.name, series.name]
            path = results.tables.get((study.case.name, LEAST.name))
            motion = table.grid("elongation_deg").sum(axis=1).mean()
            least = path.grid("elongation_deg").sum() if path is not None else np.nan
            rows.append(
                [
                    study.case.title,
                    series.name,
                    slashed(given.get(series.name)),
                    slashed(ours),
                    float(v.mean()),
                    motion / 17.0,
                    motion / least,
                    table["n_eval"].mean(),
                    1e3 * table["cpu_seconds"].mean(),
                ]
            )
    document.table(
        [
            "trajectory",
            "series",
            "published 1e-4",
            "ours 1e-4 m",
            "arithmetic mean",
            "elongation mean deg",
            "x least motion",
            "evaluations",
            "ms",
        ],
        rows,
    )


def _table_4(studies: list[Study], results: Results, document: Document) -> None:
    rows: list[list[object]] = []
    for study in studies:
        for series in PAPER:
            given = published.KANAGARAJ_TABLE_4[study.case.title][series.name]
            ours = _point_means(results, study.case.name, series.name)
            rows.append([study.case.title, f"{series.name}, published", *given])
            rows.append(["", "ours", *(f"{v:.3g}" for v in ours)])
    document.table(["trajectory", "series", "S", *(str(k) for k in range(1, 16)), "E"], rows)


def _figures(studies: list[Study], results: Results, document: Document) -> None:
    figure, axes = new_figure(12.0, 3.4, 4, same_y=True)
    for ax, study in zip(axes, studies, strict=True):
        data = {
            s.name: 1e-4 * _point_means(results, study.case.name, s.name)
            for s in [*PAPER, *(s for s in CONTROLS if s.name in SHOWN), *REFERENCES]
        }
        boxes(ax, data, "mean error of a point [m]" if ax is axes[0] else "", log=True)
        ax.set_title(study.case.title, fontsize=9)
    document.figure(figure, "E4a-boxes", "E4a: mean errors of the 17 points (Figure 5)")
    panels = []
    for study in studies:
        paths = {"asked": study.case.p}
        for name in ("PSO", "WOA"):
            q = results.tables[study.case.name, name].q[:17].copy()
            paths[name] = forward_batch(study.case.arm.chain, q)[1]
        panels.append((study.case.title, paths))
    document.figure(paths_3d(panels, 12.0, 3.2, "m"), "E4a-paths", "E4a: paths of the first run")


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    document.say(
        "**The coordinates are ours**: [K] gives none. Published errors compare only in ratio, and "
        "their unit is not stated (metres, most likely). Position only; the orientation is not "
        "controlled. N = 60, T = 100. `BAT, shared`: circulating bat code with the paper's "
        "frequencies, omega and gamma. Each entry: geometric mean (what [K] calls mean) / median / "
        "std (ddof 0) / min / max of the 17 mean errors over the runs, in 1e-4."
    )
    groups = {name: [s for s in studies if s.case.name.startswith(name)] for name in GROUPS}
    for name, title in GROUPS.items():
        document.heading(f"{name}: {title}", 3)
        _table_5(groups[name], results, document)
        if name == "E4a":
            document.say("By point, as Table 4, 1e-4:")
            _table_4(groups[name], results, document)
            _figures(groups[name], results, document)
            _note(groups[name], results, document)
            _claims(groups[name], results, document)


def _note(studies: list[Study], results: Results, document: Document) -> None:
    worst = max(
        float(_point_means(results, s.case.name, name).mean())
        for s in studies
        for name in ("BAT", "GSA")
    )
    best = min(
        float(_point_means(results, s.case.name, name).mean())
        for s in studies
        for name in ("BAT", "GSA", "BAT, shared", "BAT, decay/iteration", "GSA, alpha 20")
    )
    document.say(
        f"Published are 0.03e-4 for BAT and 0.2e-4 for GSA. As printed, and with what was tried "
        f"beside it, they end between {best:.3g}e-4 and {worst:.3g}e-4 m in the mean over a path."
    )


def _geometric(grid: Array) -> float:
    """What [K] calls mean: the geometric mean over the points of the means over the runs."""
    # The rounding of the errors' floor does not count.
    # As stats.gmean, which is many times slower, and a bootstrap calls it a thousand times.
    return float(np.exp(np.log(np.maximum(1e4 * grid.mean(axis=0), 1e-12)).mean()))


def _claims(studies: list[Study], results: Results, document: Document) -> None:
    given = published.KANAGARAJ_TABLE_5
    for study in studies:
        trajectory, case = study.case.title, study.case.name
        for series in PAPER:
            grid = results.tables[case, series.name].grid("eps_p")
            worst = 1e-4 * given[trajectory][series.name][4]
            below = share(grid.mean(axis=1), worst)
            document.figure_claim(
                f"E4a, {trajectory} (coordinates ours): geometric mean error of {series.name}",
                given[trajectory][series.name][0],
                estimate(grid, _geometric),
                "x 1e-4 m",
                f"median of all solves {short(1e4 * float(np.median(grid)))}; runs whose mean is "
                f"at or below the published maximum: {100 * below.value:.0f} % "
                f"({100 * below.low:.0f} to {100 * below.high:.0f})",
            )
        _order(study, results, document)
        _readings(study, results, document)


def _medians(case: str, name: str, results: Results) -> Array:
    """Median over the runs of each point."""
    return np.asarray(np.median(results.tables[case, name].grid("eps_p"), axis=0))


def _middle(case: str, name: str, results: Results) -> str:
    return short(1e4 * float(np.median(_medians(case, name, results))))


def _order(study: Study, results: Results, document: Document) -> None:
    """Whether each of the published order is smaller than the next, over the 17 points."""
    case = study.case.name
    values = {n: _medians(case, n, results) for n in NAMES}
    pairs = list(itertools.pairwise(NAMES))
    tests = adjusted([over_targets(values[a], values[b]) for a, b in pairs])
    order = sorted(NAMES, key=lambda n: float(np.median(values[n])))
    told = "; ".join(f"{a} < {b}: {t.told()}" for (a, b), t in zip(pairs, tests, strict=True))
    document.claim(
        f"E4a, {study.case.title}: order of the errors is {' < '.join(NAMES)}",
        "yes",
        f"by medians: {' < '.join(order)}; Friedman p = {friedman(values):.1g}",
        tests[0].n,
        f"{tests[0].test}, Holm over {len(tests)}: {told}",
        smallest(tests),
    )


def _readings(study: Study, results: Results, document: Document) -> None:
    """The readings of BAT and PSO that come nearest, and the references of today."""
    case = study.case.name
    best = results.tables[case, "PSO"]
    rivals = ["BAT, shared", "CMA-ES", "L-SHADE"]
    tests = adjusted(
        [over_targets(_medians(case, "PSO", results), _medians(case, n, results)) for n in rivals]
    )
    for name, test in zip(rivals, tests, strict=True):
        own = estimate(best.grid("eps_p"), _geometric)
        other = estimate(results.tables[case, name].grid("eps_p"), _geometric)
        document.claim(
            f"E4a, {study.case.title}: PSO has a smaller error than {name}",
            "not done",
            f"medians of the points {_middle(case, 'PSO', results)} against "
            f"{_middle(case, name, results)}; geometric means {told(own)} against {told(other)} "
            "x 1e-4 m",
            f"{test.n}, medians over the runs",
            f"{test.test}, Holm over {len(rivals)}: {test.told()}",
            HOLDS if test.first_is_smaller else FAILS if test.second_is_smaller else UNDECIDED,
        )


GROUPS = {
    "E4a": "warm start, individual 0 is the previous configuration",
    "E4b": "cold start",
    "E4u": "warm start, U axis limited to -70..190 deg as in the URDF",
}

EXPERIMENT = Experiment("E4", "Four trajectories, MH5 [K, sections 3.6-4.1]", studies, report)
