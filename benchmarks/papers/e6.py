"""E6: joint variation and ranking, [K] sections 4.3 and 4.4."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import e4, e5, published
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.plots import boxes, new_figure
from benchmarks.papers.statistics import average_ranks, friedman, holm, paired
from ikplan.kinematics.forward import jacobian

__all__ = ["EXPERIMENT"]

Array = NDArray[np.float64]

NAMES = [s.name for s in e4.PAPER]
PAIRS = [(a, b) for i, a in enumerate(NAMES) for b in NAMES[i + 1 :]]


def studies(_thin: int) -> list[Study]:
    """Return the warm cases of E4, and E5: their rows are shared."""
    warm = [s for s in e4.EXPERIMENT.studies(1) if s.case.name.startswith("E4a")]
    return [*warm, *e5.studies(1)]


def _singular(study: Study, results: Results, name: str) -> Array:
    """Smallest singular value of the translational Jacobian, shape (rows,) [m/rad]."""
    q = results.tables[study.case.name, name].q
    rows = [jacobian(study.case.arm.chain, np.ascontiguousarray(row))[:3] for row in q]
    return np.array([np.linalg.svd(J, compute_uv=False)[-1] for J in rows])


def _criteria(trajectory: str, results: Results) -> dict[str, dict[str, Array]]:
    """Run-wise values: error, iterations to 1e-3 m, and joint variation of the whole path."""
    made: dict[str, dict[str, Array]] = {"error": {}, "convergence": {}, "variation": {}}
    for name in NAMES:
        table = results.tables[f"E4a-{trajectory}", name]
        made["error"][name] = table.grid("eps_p").mean(axis=1)
        made["variation"][name] = table.grid("elongation_deg").sum(axis=1)
        curve = results.curves[f"E5-{trajectory}", name][:, 0]
        made["convergence"][name] = e5.iterations_to(1e-3, curve)
    return made


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    tracking = [s for s in studies if s.case.name.startswith("E4a")]
    document.say(
        "From the rows of E4a and E5. Joint variation: sum over the points of ||q_k - q_k-1||. "
        "Staying inside the limits is no test of singularity, so the smallest singular value of "
        "the translational Jacobian is given too."
    )
    rows = []
    for study in tracking:
        for series in study.series:
            table = results.tables[study.case.name, series.name]
            q = table.q.reshape(-1, study.case.count, study.case.arm.dof)
            start = np.broadcast_to(study.case.q_start, (len(q), 1, study.case.arm.dof))
            steps = np.degrees(np.abs(np.diff(np.concatenate([start, q], axis=1), axis=1)))
            lower, upper = study.case.arm.lower, study.case.arm.upper
            at_limit = (np.abs(q - lower) < 1e-9) | (np.abs(q - upper) < 1e-9)
            smallest = _singular(study, results, series.name)
            rows.append(
                [
                    study.case.title,
                    series.name,
                    table.grid("elongation_deg").sum(axis=1).mean(),
                    float(steps.max()),
                    100.0 * at_limit.mean(),
                    float(np.median(smallest)),
                    float(smallest.min()),
                ]
            )
    document.table(
        [
            "trajectory",
            "series",
            "variation of the path deg",
            "largest joint step deg",
            "% joints at a limit",
            "singular value median",
            "min",
        ],
        rows,
    )
    _ranks(tracking, results, document)
    figure, axes = new_figure(12.0, 3.4, 4, same_y=True)
    for ax, study in zip(axes, tracking, strict=True):
        shown = [*NAMES, e4.WHOLE.name]
        data = {
            n: results.tables[study.case.name, n].grid("elongation_deg").sum(axis=1) for n in shown
        }
        boxes(ax, data, "variation of the path [deg]" if ax is axes[0] else "")
        ax.set_title(study.case.title, fontsize=9)
    document.figure(figure, "E6-variation", "E6: joint variation of each run")


def _ranks(tracking: list[Study], results: Results, document: Document) -> None:
    document.say(
        "Ranks of BAT, GSA, PSO, WOA. [K] calls this a Wilcoxon test, but prints ranks only. Ours: "
        "by the mean, and beside them the average rank over the runs, Friedman's p, and the pairs "
        "that Wilcoxon's test (Holm) does not tell apart at 0.05."
    )
    rows, totals, given_totals = [], [], []
    details = []
    for study in tracking:
        for criterion, values in _criteria(study.case.title, results).items():
            means = [float(v.mean()) for v in values.values()]
            ranks = [1 + sum(other < m for other in means) for m in means]
            given = published.KANAGARAJ_RANKS[criterion][study.case.title]
            totals.append(ranks)
            given_totals.append(given)
            tests = [paired(values[a], values[b]) for a, b in PAIRS]
            adjusted = holm([p for p, _ in tests])
            equal = [f"{a}-{b}" for (a, b), p in zip(PAIRS, adjusted, strict=True) if p > 0.05]
            average = average_ranks(values)
            rows.append(
                [
                    study.case.title,
                    criterion,
                    ", ".join(str(r) for r in given),
                    ", ".join(str(r) for r in ranks),
                    ", ".join(f"{average[n]:.2f}" for n in NAMES),
                    friedman(values),
                    ", ".join(equal) or "none",
                ]
            )
            details.append(
                [
                    study.case.title,
                    criterion,
                    *(
                        f"{p:.2g} ({effect:+.2f})"
                        for p, (_, effect) in zip(adjusted, tests, strict=True)
                    ),
                ]
            )
    document.table(
        [
            "trajectory",
            "criterion",
            "published",
            "ours",
            "average ranks",
            "Friedman p",
            "not told apart",
        ],
        rows,
    )
    theirs: Array = np.array(given_totals, dtype=np.float64).mean(axis=0)
    ours: Array = np.array(totals, dtype=np.float64).mean(axis=0)
    document.say(
        f"Average of the ranks: published {', '.join(f'{v:.2f}' for v in theirs)}; ours "
        f"{', '.join(f'{v:.2f}' for v in ours)}. Published final order BAT, GSA, WOA, PSO; "
        f"ours {', '.join(NAMES[i] for i in np.argsort(ours))}."
    )
    final = [NAMES[i] for i in np.argsort(ours)]
    document.claim(
        "E6: final order by the average of ranks",
        "BAT, GSA, WOA, PSO (1.58, 2.08, 2.75, 3.58)",
        f"{', '.join(final)} ({', '.join(f'{v:.2f}' for v in sorted(ours))})",
        "reproduced" if final == ["BAT", "GSA", "WOA", "PSO"] else "not reproduced",
    )
    document.say("Each pair: p (Holm), and the matched-pairs rank-biserial effect.")
    document.table(["trajectory", "criterion", *(f"{a}-{b}" for a, b in PAIRS)], details)


EXPERIMENT = Experiment("E6", "Joint variation and ranking, MH5 [K, 4.3-4.4]", studies, report)
