"""What E1 says of the claims of [S], and why IK-BA misses where it does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import published
from benchmarks.papers.case import Case
from benchmarks.papers.claims import against
from benchmarks.papers.document import Document
from benchmarks.papers.e1_series import (
    CALIBRATED,
    CLOUD,
    GREEDY,
    IK_BA,
    LEAST,
    MISS,
    PAPER,
    WHOLE,
    per_run,
)
from benchmarks.papers.experiment import Results, Study
from benchmarks.papers.statistics import holm, paired

__all__ = ["claims", "far_from_the_edge", "misses"]

EDGE = 0.8175
"""Distance of the wrist from the shoulder beyond which the arm is nearly straight [m]; 0.82 is its
reach."""
SHOULDER = np.array([0.0, 0.0, 0.36])
WRIST = 0.126


def far_from_the_edge(case: Case) -> NDArray[np.bool_]:
    """Return which points of a decoupled case are not at the very edge of the reach."""
    wrist = case.p - WRIST * case.R[:, :, 2]
    far: NDArray[np.bool_] = np.linalg.norm(wrist - SHOULDER, axis=1) < EDGE
    return far


def misses(study: Study, results: Results, document: Document) -> None:
    """Why the mean of IK-BA is what it is: solves that end at a joint limit, points at the edge."""
    case = study.case
    lower, upper = case.arm.lower[: case.width], case.arm.upper[: case.width]
    for series in (IK_BA, CALIBRATED, CLOUD):
        table = results.tables[case.name, series.name]
        error: NDArray[np.float64] = 100.0 * table["eps_p"]
        x = table.q[:, : case.width]
        at_limit = ((x <= lower + 1e-6) | (x >= upper - 1e-6)).any(axis=1)
        missed = np.asarray(error > MISS)
        runs = np.asarray((100.0 * table.grid("eps_p") > MISS).any(axis=1))
        text = (
            f"{series.name}: {int(missed.sum())} of {len(error)} solves miss by more than {MISS} "
            f"cm, in {int(runs.sum())} of {len(runs)} runs; {int((missed & at_limit).sum())} of "
            "them have a searched joint at its limit. The other solves have a mean error of "
            f"{error[~missed].mean():.4g} cm."
        )
        if case.decouple and not far_from_the_edge(case).all():
            far = table.where(far_from_the_edge(case))
            points = ", ".join(str(k + 1) for k in np.flatnonzero(~far_from_the_edge(case)))
            text += (
                f" Without the points {points}, where the arm is all but straight: "
                f"{100.0 * far['eps_p'].mean():.4g} cm over all solves."
            )
        document.say(text)


def _centimetres(results: Results, cases: tuple[str, ...], series: str) -> str:
    errors = {c: 100.0 * results.tables[c, series]["eps_p"] for c in cases}
    return ", ".join(f"{c} {e.mean():.2g} (median {np.median(e):.2g})" for c, e in errors.items())


def _smallest(results: Results, case: str, column: str) -> tuple[str, bool]:
    """Which of the six has the smallest mean; whether it is IK-BA, told apart from every other."""
    values = {s.name: per_run(results.tables[case, s.name], column) for s in PAPER}
    best = min(values, key=lambda name: float(values[name].mean()))
    others = [n for n in values if n != IK_BA.name]
    tests = [paired(values[IK_BA.name], values[n]) for n in others]
    adjusted = holm([p for p, _ in tests])
    if best == IK_BA.name:
        return f"{case}: IK-BA, p <= {max(adjusted):.1g} against each", max(adjusted) < 0.05
    i = others.index(best)
    return f"{case}: {best}, p = {adjusted[i]:.1g} against IK-BA", False


def _around_the_start(results: Results, case: str, column: str) -> str:
    """The order of the six when all of them begin around the start."""
    means = {s.name: float(results.tables[case, f"{s.name}, cloud"][column].mean()) for s in PAPER}
    return f"{case}: {' < '.join(sorted(means, key=lambda name: means[name]))}"


def claims(studies: dict[str, Study], results: Results, document: Document) -> None:
    """Fill the summary."""
    cases = ("E1a", "E1b", "E1c")
    given = published.SLIM_TABLE_3
    e, v = given["eps_p"]["IK-BA"][0], given["elongation_deg"]["IK-BA"][0]
    mean = {c: 100.0 * results.tables[c, IK_BA.name]["eps_p"].mean() for c in cases}
    document.claim(
        "E1: mean position error of IK-BA on the helix, noise as printed",
        f"{e:g} cm",
        _centimetres(results, cases, IK_BA.name) + " cm",
        "; ".join(f"{c} {against(e, m)}" for c, m in mean.items()),
    )
    far = far_from_the_edge(studies["E1b"].case)
    for series, words in (
        (CALIBRATED, "noise x 0.15 (calibrated by us), first population over the whole range"),
        (CLOUD, "noise x 0.15, first population around the start"),
    ):
        table = results.tables["E1b", series.name]
        mean = {c: 100.0 * results.tables[c, series.name]["eps_p"].mean() for c in cases}
        inner = 100.0 * table.where(far)["eps_p"].mean()
        document.claim(
            f"E1: the same, {words}",
            f"{e:g} cm (asked of E1b: at most 0.0025)",
            f"{_centimetres(results, cases, series.name)} cm; E1b without three points at the edge "
            f"of the reach {inner:.2g}",
            "; ".join(f"{c} {against(e, m)}" for c, m in mean.items()),
        )
    motions = {c: results.tables[c, IK_BA.name]["elongation_deg"].mean() for c in cases}
    document.claim(
        "E1: mean joint variation of IK-BA",
        f"{v:.3g} deg",
        ", ".join(f"{c} {m:.3g}" for c, m in motions.items()) + " deg",
        "; ".join(f"{c} {against(v, m)}" for c, m in motions.items()),
    )
    if results.runs >= 6:
        for column, title in (("eps_p", "error"), ("elongation_deg", "variation")):
            lines = [_smallest(results, c, column) for c in cases]
            holds = sum(held for _, held in lines)
            document.claim(
                f"E1: IK-BA has the smallest {title} of the six",
                "yes (ANOVA of all six)",
                "; ".join(line for line, _ in lines),
                f"holds on {holds} of 3 readings (p < 0.05)",
            )
    for column, title in (("eps_p", "error"), ("elongation_deg", "variation")):
        orders = [_around_the_start(results, c, column) for c in cases]
        first = sum(": IK-BA <" in order for order in orders)
        document.claim(
            f"E1: order by mean {title} when all six begin around the start",
            "not done",
            "; ".join(orders),
            f"IK-BA is first on {first} of 3 readings",
        )
    for name in ("E1a", "E1b"):
        least = results.tables[name, LEAST.name].grid("elongation_deg").sum()

        def ratio(series: str, name: str = name, least: float = least) -> float:
            path = results.tables[name, series].grid("elongation_deg").sum(axis=1)
            return float(path.mean() / least)

        document.claim(
            f"{name}: joint motion of the whole path over the true optimum",
            "-",
            f"ikplan {ratio(WHOLE.name):.4f} (greedy {ratio(GREEDY.name):.4f}), IK-BA "
            f"{ratio(IK_BA.name):.3g}, calibrated {ratio(CALIBRATED.name):.3g}",
            f"ikplan moves the joints {ratio(IK_BA.name) / ratio(WHOLE.name):.1f} times less",
        )
