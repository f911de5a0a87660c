"""E3: the circle of the Dobot, [S] section 6."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import published
from benchmarks.papers.case import Case
from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.plots import curves, legend_below, new_figure
from benchmarks.papers.series import OPTIMUM, PLANNER, Series, references
from benchmarks.papers.statistics import adjusted, estimate, over_targets
from ikplan.kinematics.arm import arm_of
from ikplan.robots import load_robot

__all__ = ["EXPERIMENT"]

Array = NDArray[np.float64]

N, T = 50, 1000
OPTIMAL = Series("closed form", OPTIMUM, paper=False)
SERIES = [
    Series("IK-BA", "ik-ba", N, T, {"preset": "bat-code"}),
    Series("IK-BA, uniform noise", "ik-ba", N, T, {"preset": "slim"}, paper=False),
    Series("IK-BA, loudness", "ik-ba", N, T, {"preset": "bat-code", "accept": "loudness"}, False),
    Series("BA", "ba", N, T),
    Series("DE", "de-rand-1", N, T, {"preset": "slim"}),
    Series("PSO", "pso", N, T, {"preset": "slim-permuted"}),
    Series("ABC", "abc", N, T),
    *references(N, T),
    Series("ikplan", PLANNER, params={"elongation": "global"}, paper=False),
    OPTIMAL,
]
MACHINE = 0.02
"""Mechanical precision of the arm [cm], [S]."""


def same_yaw(x: Array) -> Array:
    """Return (theta1..theta3, theta4 = theta1), as [S] sets it."""
    return np.array([x[0], x[1], x[2], x[0]])


def studies(_thin: int) -> list[Study]:
    """Return the one case."""
    robot = load_robot("dobot_magician")
    phi = np.radians(18.0 * np.arange(20))
    p = np.column_stack([0.16 + 0.07 * np.cos(phi), 0.16 + 0.07 * np.sin(phi), np.zeros(20)])
    case = Case(
        "E3",
        "circle",
        robot,
        arm_of(robot),
        np.tile(np.eye(3), (20, 1, 1)),
        p,
        False,
        np.radians([0.0, 45.0, 45.0, 0.0]),
        searched=3,
        reachable=np.ones(20, dtype=np.bool_),
        finish=same_yaw,
    )
    return [Study(case, SERIES)]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    case = studies[0].case
    errors = np.array(published.DOBOT_ERRORS)
    corrected = np.where(errors == 9.61, 0.961, errors).mean()
    document.say(
        f"3 joints searched, theta4 = theta1, N = {N}, T = {T}. Published mean error 2.1196e-14 "
        f"cm; the 20 printed errors average {errors.mean():.3f}e-14, with point 12 read as "
        f"9.61e-15 {corrected:.3f}e-14: a misprint. Coordinates near 23 cm round at 4e-15 cm."
    )
    printed = np.array(published.DOBOT_TABLE_8)[:, [0, 1, 2, 0]]
    least = results.tables[case.name, OPTIMAL.name]["elongation_deg"].sum()
    rows = []
    for series in studies[0].series:
        table = results.tables[case.name, series.name]
        q = np.degrees(table.q).reshape(-1, 20, 4)
        error = 100.0 * table.grid("eps_p")
        away = np.abs(np.round(q, 1) - printed)
        rows.append(
            [
                series.name,
                error.mean(),
                float(np.median(error)),
                error.max(),
                float(np.abs(q - printed).max()),
                f"{int((away < 0.05).sum())} of {away.size}",
                table.grid("elongation_deg").sum(axis=1).mean() / least,
                table["n_eval"].mean(),
                1e3 * table["cpu_seconds"].mean(),
            ]
        )
    document.table(
        [
            "series",
            "error mean cm",
            "median",
            "max",
            "from Table 8 max deg",
            "angles equal, rounded",
            "x least motion",
            "evaluations",
            "ms",
        ],
        rows,
    )
    document.say(
        "Angles of the first run of IK-BA, rounded, beside Table 8 (theta4 = "
        "theta1), and mean errors of all runs by point, in 1e-14 cm:"
    )
    table = results.tables[case.name, "IK-BA"]
    q = np.degrees(table.q[:20])
    ours = 1e16 * table.grid("eps_p").mean(axis=0)
    document.table(
        ["point", "published", "ours", "published error", "ours"],
        [
            [
                k + 1,
                " / ".join(f"{v:.1f}" for v in printed[k, :3]),
                " / ".join(f"{v:.1f}" for v in q[k, :3]),
                published.DOBOT_ERRORS[k],
                float(ours[k]),
            ]
            for k in range(20)
        ],
    )
    for name, words in (
        ("IK-BA", "noise of bat code, 0.1 N(0, 1)"),
        ("IK-BA, uniform noise", "noise uniform in [-1, 1)"),
    ):
        _claims(name, words, results, case, printed, document)
    _compared(results, case, document)
    figure, axes = new_figure(7.0, 3.6)
    lines = {
        s.name: np.maximum(100.0 * results.curves[case.name, s.name][:, 2].mean(axis=0), 1e-15)
        for s in studies[0].series
        if (case.name, s.name) in results.curves
    }
    curves(axes[0], lines, "iteration", "mean error [cm]", log=True)
    legend_below(figure, axes[0])
    axes[0].axhline(MACHINE, color="black", linewidth=0.8, linestyle=":")
    axes[0].annotate("precision of the arm", (T, MACHINE), fontsize=7, ha="right", va="top")
    document.figure(figure, "E3-convergence", "E3: mean error over the iterations (Figure 18)")


def _claims(
    name: str, words: str, results: Results, case: Case, printed: Array, document: Document
) -> None:
    table = results.tables[case.name, name]
    q = np.degrees(table.q).reshape(-1, 20, 4)
    equal = int((np.abs(np.round(q, 1) - printed) < 0.05).sum())
    grid = 100.0 * table.grid("eps_p")
    document.claim(
        f"E3: angles of Table 8, IK-BA, {words}",
        "80 angles",
        f"{equal:,} of {q.size:,} equal after rounding to 0.1 deg",
        f"{grid.shape[0]} runs x {q.shape[1] * q.shape[2]} angles",
        "every angle of every run",
        HOLDS if equal == q.size else FAILS,
    )
    document.figure_claim(f"E3: mean error of IK-BA, {words}", 2.1196e-14, estimate(grid), "cm")


def _compared(results: Results, case: Case, document: Document) -> None:
    """IK-BA against each other search, over the 20 points."""

    def median(name: str) -> Array:
        return np.asarray(np.median(results.tables[case.name, name].grid("eps_p"), axis=0))

    others = ["BA", "DE", "PSO", "ABC", "CMA-ES", "L-SHADE"]
    tests = adjusted([over_targets(median("IK-BA"), median(name)) for name in others])
    for name, test in zip(others, tests, strict=True):
        document.claim(
            f"E3: IK-BA has a smaller error than {name}",
            "not done",
            f"medians {100 * float(np.median(median('IK-BA'))):.2g} against "
            f"{100 * float(np.median(median(name))):.2g} cm",
            test.n,
            f"{test.test} over medians a point, Holm over {len(others)}: {test.told()}",
            HOLDS if test.first_is_smaller else FAILS if test.second_is_smaller else UNDECIDED,
        )


EXPERIMENT = Experiment("E3", "Dobot circle [S, section 6]", studies, report)
