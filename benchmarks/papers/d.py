"""D: readings of the papers' text, and what each does."""

from __future__ import annotations

import numpy as np

from benchmarks.papers.deviations import GROUPS, RUNS, studies
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.li_tables import by_target
from benchmarks.papers.statistics import adjusted, over_targets

__all__ = ["EXPERIMENT"]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    document.say(
        "Where a paper's text can be read in more than one way, or the code does otherwise, each "
        "reading is an option of the solver. 100 random positions an arm, cold but for what begins "
        f"warm by default (IK-BA, BAT), the paper's N and T, at most {RUNS} runs: the targets are "
        "what the tests are over. The first line of a table is what the report takes; p: Wilcoxon "
        "over the medians a target against it, Holm within the table; effect: 1 where the first "
        "line is smaller at every target, 0 where the other is."
    )
    for study in studies:
        case = study.case
        document.heading(f"{case.name}: {case.title}", 3)
        for group in GROUPS[case.name]:
            tables = [results.tables[case.name, s.name] for _, s in group]
            medians = [by_target(t, "eps_p") for t in tables]
            tests = adjusted([over_targets(medians[0], m) for m in medians[1:]])
            rows: list[list[object]] = []
            for i, (text, series) in enumerate(group):
                millimetres = 1e3 * tables[i]["eps_p"]
                row: list[object] = [series.name, text, float(np.median(millimetres))]
                row += [float(np.quantile(millimetres, 0.95)), tables[i]["n_eval"].mean()]
                if i == 0:
                    row += [None, None]
                else:
                    test = tests[i - 1]
                    told = f"{test.effect:.2f} ({test.low:.2f} to {test.high:.2f})"
                    row += [test.p, told]
                rows.append(row)
            head = ["series", "reading", "median mm", "95 % mm", "evaluations", "p", "effect"]
            document.table(head, rows)


EXPERIMENT = Experiment("D", "Readings of the papers' text, and what each does", studies, report)
