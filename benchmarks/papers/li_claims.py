"""Claims and a figure that E7 and E8 share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from benchmarks.papers.claims import against
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Results
from benchmarks.papers.li_tables import by_target, solved
from benchmarks.papers.plots import boxes, curves, legend_below, new_figure
from benchmarks.papers.series import Series
from benchmarks.papers.statistics import holm, paired

__all__ = ["convergence", "pose_claims"]


def convergence(
    case: str, paper: Sequence[Series], own: Series, results: Results, document: Document
) -> None:
    """Draw the fitness over the iterations, and position and orientation errors of all solves."""
    figure, axes = new_figure(13.0, 4.2, 3)
    lines = {s.name: np.exp(np.log(results.curves[case, s.name][:, 0]).mean(axis=0)) for s in paper}
    curves(axes[0], lines, "iteration", "fitness [mm], geometric mean", log=True)
    legend_below(figure, axes[0])
    tables = {s.name: results.tables[case, s.name] for s in [*paper, own]}
    millimetres = {name: 1e3 * table["eps_p"] for name, table in tables.items()}
    boxes(axes[1], millimetres, "position error [mm]", log=True)
    boxes(axes[2], {n: t["theta_deg"] for n, t in tables.items()}, "orientation error [deg]")
    document.figure(
        figure,
        f"{case}-convergence",
        f"{case}: convergence; position and orientation errors of all solves",
    )


def pose_claims(
    case: str,
    title: str,
    given: Mapping[str, tuple[float, float]],
    paper: Sequence[Series],
    own: Series,
    results: Results,
    document: Document,
) -> None:
    """Fill the summary: BODE-CS, whether it is the best, and what it does to the orientation."""
    first = paper[0].name
    table = results.tables[case, first]
    millimetres = 1e3 * table["eps_p"]
    maxima = 1e3 * table.grid("eps_p").max(axis=1)
    largest = float(maxima.mean())
    document.claim(
        f"{title}: largest position error of {first} over 100 poses",
        f"{given[first][0]:g} mm",
        f"{largest:.2g} mm (mean over the runs, least {maxima.min():.2g}); median of all solves "
        f"{np.median(millimetres):.2g}, 95 % quantile {np.quantile(millimetres, 0.95):.2g}; "
        f"{100.0 * (millimetres > given[first][0]).mean():.1f} % above the published maximum",
        against(given[first][0], largest),
    )
    others = [s.name for s in paper[1:]]
    mine = by_target(table, "eps_p")
    tests = [paired(mine, by_target(results.tables[case, n], "eps_p")) for n in others]
    adjusted = holm([p for p, _ in tests])
    beaten = [effect < 0.0 and p < 0.05 for p, (_, effect) in zip(adjusted, tests, strict=True)]
    lost = [n for n, won in zip(others, beaten, strict=True) if not won]
    document.claim(
        f"{title}: {first} has a smaller position error than each of the ten others",
        "yes (by maxima, no test)",
        f"than {sum(beaten)} of {len(others)}, p < 0.05 (Wilcoxon over the poses, Holm)"
        + (f"; not than {', '.join(lost)}" if lost else ""),
        "reproduced" if not lost else "not reproduced for all",
    )
    ours = results.tables[case, own.name]
    angle = 2.0 * np.degrees(np.arcsin(1.731 / np.sqrt(8.0)))
    document.claim(
        f"{title}: orientation error of {first}",
        f"not given; its fitness implies about {angle:.0f} deg" if case == "E7a" else "not given",
        f"mean {table['theta_deg'].mean():.0f} deg; poses solved {100.0 * solved(table):.1f} % "
        f"(the project's planner: {100.0 * solved(ours):.0f} %)",
        "the orientation is not solved",
    )
