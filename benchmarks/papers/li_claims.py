"""Claims and a figure that E7 and E8 share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED, one_of_ours, short, smallest, told
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Results
from benchmarks.papers.li_tables import Targets, by_target
from benchmarks.papers.plots import boxes, curves, legend_below, new_figure
from benchmarks.papers.rows import Table
from benchmarks.papers.series import Series
from benchmarks.papers.statistics import (
    Comparison,
    Estimate,
    adjusted,
    estimate,
    over_targets,
    share,
)

__all__ = ["beats", "convergence", "per_cent", "pose_claims", "run_maximum", "solved_share"]

Array = NDArray[np.float64]


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


def _millimetres(table: Table) -> Array:
    grid: Array = 1e3 * table.grid("eps_p")
    return grid


def run_maximum(
    subject: str, given: float, table: Table, document: Document, targets: int = 100
) -> None:
    """Claim the largest error of one run, which is what one published run has.

    Args:
        subject: What is claimed.
        given: The published maximum over the targets of one run [mm].
        table: Our runs.
        document: The report.
        targets: Targets of the published run: a maximum over fewer is another figure.
    """
    grid = _millimetres(table)
    maxima = grid.max(axis=1)
    below = share(maxima, given)
    middle = estimate(grid, lambda v: float(np.median(v.max(axis=1))))
    above = estimate((grid > given).astype(float))
    verdict, small, large = one_of_ours(maxima, given)
    if grid.shape[1] < targets:
        verdict = UNDECIDED
    document.claim(
        subject,
        f"{given:g} mm",
        f"run maxima: median {told(middle)}, {short(maxima.min())} to {short(maxima.max())} mm; "
        f"median of all solves {short(float(np.median(grid)))}; "
        f"{100 * above.value:.1f} % ({100 * above.low:.1f} to {100 * above.high:.1f}) of the "
        "solves above",
        middle.n,
        f"runs at or below: {100 * below.value:.0f} % ({100 * below.low:.0f} to "
        f"{100 * below.high:.0f}); rank of one run among ours: p = {min(small, large):.2g}",
        verdict,
    )


def beats(
    title: str,
    case: str,
    column: str,
    what: str,
    paper: Sequence[Series],
    references: Sequence[Series],
    results: Results,
    document: Document,
    targets: Targets = None,
) -> None:
    """Claim that the first is smaller than each other, and, apart, than each reference."""
    first = paper[0].name
    mine = by_target(results.tables[case, first], column, targets)

    def tests_of(series: Sequence[Series]) -> list[Comparison]:
        return adjusted(
            [
                over_targets(mine, by_target(results.tables[case, s.name], column, targets))
                for s in series
            ]
        )

    others = paper[1:]
    tests = tests_of(others)
    lost = [s.name for s, t in zip(others, tests, strict=True) if not t.first_is_smaller]
    worst = min(tests, key=lambda t: t.effect)
    rival = others[tests.index(worst)].name
    document.claim(
        f"{title}: {first} has a smaller {what} than each of the ten others",
        "yes (by maxima, no test)",
        f"than {len(others) - len(lost)} of {len(others)}"
        + (f"; not than {', '.join(lost)}" if lost else ""),
        f"{worst.n}, medians over the runs",
        f"{worst.test}, Holm over {len(others)}: against {rival} {worst.told()}",
        smallest(tests),
    )
    for s, test in zip(references, tests_of(references), strict=True):
        other = by_target(results.tables[case, s.name], column, targets)
        factor = 1e3 if column == "eps_p" else 1.0
        document.claim(
            f"{title}: {first} has a smaller {what} than {s.name}",
            "not done",
            f"medians {short(factor * float(np.median(mine)))} against "
            f"{short(factor * float(np.median(other)))} mm",
            f"{test.n}, medians over the runs",
            f"{test.test}, Holm over {len(references)}: {test.told()}",
            HOLDS if test.first_is_smaller else FAILS if test.second_is_smaller else UNDECIDED,
        )


def solved_share(table: Table) -> Estimate:
    """Return the share of solves within 0.1 mm and 0.1 deg, with its interval."""
    met = (table.grid("eps_p") <= 1e-4) & (table.grid("theta_deg") <= 0.1)
    return estimate(met.astype(float))


def per_cent(value: Estimate) -> str:
    """Write a share in per cent with its interval."""
    return f"{100 * value.value:.0f} % ({100 * value.low:.0f} to {100 * value.high:.0f})"


def pose_claims(
    case: str,
    title: str,
    given: Mapping[str, tuple[float, float]],
    paper: Sequence[Series],
    references: Sequence[Series],
    own: Series,
    results: Results,
    document: Document,
) -> None:
    """Fill the summary: every maximum, whether BODE-CS is the best, and the orientation."""
    first = paper[0].name
    for s in paper:
        run_maximum(
            f"{title}: largest position error of {s.name} over the poses of a run",
            given[s.name][0],
            results.tables[case, s.name],
            document,
        )
    for column, what in (("eps_p", "position error"), ("f", "fitness")):
        beats(title, case, column, what, paper, references, results, document)
    table = results.tables[case, first]
    angle = 2.0 * np.degrees(np.arcsin(1.731 / np.sqrt(8.0)))
    met = solved_share(table)
    document.claim(
        f"{title}: {first} solves the orientation",
        f"not given; its fitness implies about {angle:.0f} deg" if case == "E7a" else "not given",
        f"mean {told(estimate(table.grid('theta_deg')))} deg; poses solved {per_cent(met)}; by the "
        f"project's planner {per_cent(solved_share(results.tables[case, own.name]))}",
        met.n,
        "bootstrap of the share of poses within 0.1 mm and 0.1 deg",
        HOLDS if met.low > 0.95 else FAILS if met.high < 0.95 else UNDECIDED,
    )
