"""E6: joint variation and ranking, [K] sections 4.3 and 4.4."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from benchmarks.papers import e4, e5, published
from benchmarks.papers.claims import FAILS, HOLDS, UNDECIDED
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.plots import boxes, new_figure
from benchmarks.papers.statistics import adjusted, over_runs
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
        shown = [*NAMES, "CMA-ES", "L-SHADE", e4.WHOLE.name]
        data = {
            n: results.tables[study.case.name, n].grid("elongation_deg").sum(axis=1) for n in shown
        }
        boxes(ax, data, "variation of the path [deg]" if ax is axes[0] else "")
        ax.set_title(study.case.title, fontsize=9)
    document.figure(figure, "E6-variation", "E6: joint variation of each run")


def _ranks(tracking: list[Study], results: Results, document: Document) -> None:
    document.say(
        "Ranks of BAT, GSA, PSO, WOA. [K] calls this a Wilcoxon test, but prints ranks only. Ours: "
        "by the mean, and beside them the pairs that Mann and Whitney's test over the runs (Holm "
        "over the six) does not tell apart at 0.05, and the p of Kruskal and Wallis over all four."
    )
    rows, totals, given_totals, drawn = [], [], [], []
    details = []
    rng = np.random.Generator(np.random.PCG64(6))
    for study in tracking:
        for criterion, values in _criteria(study.case.title, results).items():
            ranks = _rank([float(v.mean()) for v in values.values()])
            given = published.KANAGARAJ_RANKS[criterion][study.case.title]
            totals.append(ranks)
            given_totals.append(given)
            tests = adjusted([over_runs(values[a], values[b]) for a, b in PAIRS])
            equal = [f"{a}-{b}" for (a, b), t in zip(PAIRS, tests, strict=True) if t.p > 0.05]
            every = list(values.values())
            again = [
                _rank([float(rng.choice(v, len(v)).mean()) for v in every]) for _ in range(500)
            ]
            drawn.append(again)
            kruskal = float(stats.kruskal(*every).pvalue) if len(every[0]) > 1 else float("nan")
            rows.append(
                [
                    study.case.title,
                    criterion,
                    ", ".join(str(r) for r in given),
                    ", ".join(str(r) for r in ranks),
                    kruskal,
                    ", ".join(equal) or "none",
                ]
            )
            details.append(
                [study.case.title, criterion, *(f"{t.p:.2g} ({t.effect:.2f})" for t in tests)]
            )
    document.table(
        ["trajectory", "criterion", "published", "ours", "Kruskal p", "not told apart"], rows
    )
    theirs: Array = np.array(given_totals, dtype=np.float64).mean(axis=0)
    ours: Array = np.array(totals, dtype=np.float64).mean(axis=0)
    spread: Array = np.array(drawn, dtype=np.float64).mean(axis=0)
    low, high = np.quantile(spread, [0.025, 0.975], axis=0)
    document.say(
        f"Average of the ranks: published {', '.join(f'{v:.2f}' for v in theirs)}; ours "
        f"{', '.join(f'{v:.2f}' for v in ours)}. Published final order BAT, GSA, WOA, PSO; "
        f"ours {', '.join(NAMES[i] for i in np.argsort(ours))}."
    )
    order = ["BAT", "GSA", "WOA", "PSO"]
    kept = [[NAMES[i] for i in np.argsort(v, kind="stable")] == order for v in spread]
    same = float(np.mean(kept))
    figures = ", ".join(
        f"{NAMES[i]} {ours[i]:.2f} ({low[i]:.2f} to {high[i]:.2f})" for i in np.argsort(ours)
    )
    document.claim(
        "E6: final order by the average of ranks is BAT, GSA, WOA, PSO",
        "yes (1.58, 2.08, 2.75, 3.58)",
        figures,
        f"{len(every[0])} runs x {len(rows)} criteria",
        f"bootstrap over runs: this order in {100 * same:.0f} % of the resamples",
        HOLDS if same > 0.975 else FAILS if same < 0.025 else UNDECIDED,
    )
    document.say("Each pair: p (Holm), and A12, the probability that the first is smaller.")
    document.table(["trajectory", "criterion", *(f"{a}-{b}" for a, b in PAIRS)], details)


def _rank(means: list[float]) -> list[int]:
    return [1 + sum(other < m for other in means) for m in means]


EXPERIMENT = Experiment("E6", "Joint variation and ranking, MH5 [K, 4.3-4.4]", studies, report)
